// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/settings/resolved_limits.h"

#include <sched.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <sstream>
#include <thread>

namespace curvereg::server {
namespace {

constexpr uint64_t kMemoryWhenUnknown = uint64_t{1} << 30;

std::string ReadText(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  if (file) text << file.rdbuf();
  return text.str();
}

// The number that the text begins with; "max" and an empty text are none.
std::optional<uint64_t> LeadingNumber(const std::string& text) {
  uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() ? std::optional(number) : std::nullopt;
}

uint64_t PhysicalMemory(const std::string& root) {
  std::istringstream lines(ReadText(root + "/proc/meminfo"));
  std::string name;
  uint64_t kibibytes = 0;
  for (std::string line; std::getline(lines, line);) {
    if (std::istringstream(line) >> name >> kibibytes && name == "MemTotal:") return kibibytes << 10;
  }
  return 0;
}

// "QUOTA PERIOD" of version 2, or the same from version 1's two files, in processors; "max" and -1 are no limit.
std::optional<uint64_t> QuotaProcessors(const std::string& quota_and_period) {
  const std::optional<uint64_t> quota = LeadingNumber(quota_and_period);
  const std::size_t blank = quota_and_period.find(' ');
  if (!quota.has_value() || blank == std::string::npos) return std::nullopt;
  const std::optional<uint64_t> period = LeadingNumber(quota_and_period.substr(blank + 1));
  if (!period.has_value() || *period == 0) return std::nullopt;
  return (*quota + *period - 1) / *period;
}

// The least of what `read` finds in the group's folder and those above it: a limit holds for all groups below.
std::optional<uint64_t> LeastAbove(const std::string& mount, std::string group,
                                   const std::function<std::optional<uint64_t>(const std::string&)>& read) {
  std::optional<uint64_t> least;
  for (;;) {
    if (const std::optional<uint64_t> limit = read(mount + group)) least = std::min(*limit, least.value_or(*limit));
    if (group.empty()) return least;
    group.erase(group.find_last_of('/') == std::string::npos ? 0 : group.find_last_of('/'));
  }
}

void ApplyLimits(std::optional<uint64_t> memory, std::optional<uint64_t> processors, MachineResources& machine) {
  if (memory.has_value() && (machine.memory_bytes == 0 || *memory < machine.memory_bytes)) {
    machine.memory_bytes = *memory;
  }
  if (processors.has_value() && *processors < static_cast<uint64_t>(machine.num_processors)) {
    machine.num_processors = std::max(1, static_cast<int>(*processors));
  }
}

void ApplyVersion2(const std::string& root, const std::string& group, MachineResources& machine) {
  const std::string mount = root + "/sys/fs/cgroup";
  ApplyLimits(LeastAbove(mount, group, [](const std::string& f) { return LeadingNumber(ReadText(f + "/memory.max")); }),
              LeastAbove(mount, group, [](const std::string& f) { return QuotaProcessors(ReadText(f + "/cpu.max")); }),
              machine);
}

void ApplyVersion1(const std::string& root, const std::string& controllers, const std::string& group,
                   MachineResources& machine) {
  const std::string mount = root + "/sys/fs/cgroup/" + controllers;
  ApplyLimits(
      LeastAbove(mount, group,
                 [](const std::string& f) { return LeadingNumber(ReadText(f + "/memory.limit_in_bytes")); }),
      LeastAbove(mount, group,
                 [](const std::string& f) {
                   return QuotaProcessors(ReadText(f + "/cpu.cfs_quota_us") + " " + ReadText(f + "/cpu.cfs_period_us"));
                 }),
      machine);
}

int AllowedProcessors() {
  cpu_set_t allowed;
  if (sched_getaffinity(0, sizeof(allowed), &allowed) == 0) return std::max(1, CPU_COUNT(&allowed));
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace

MachineResources ReadMachineResources(const std::string& root) {
  MachineResources machine{AllowedProcessors(), PhysicalMemory(root)};
  // Lines "ID:CONTROLLERS:/GROUP"; version 2 has the one line "0::/GROUP".
  std::istringstream lines(ReadText(root + "/proc/self/cgroup"));
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = line.find(':');
    const std::size_t second = first == std::string::npos ? first : line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    std::string group = line.substr(second + 1);
    if (group == "/") group.clear();
    if (controllers.empty()) {
      ApplyVersion2(root, group, machine);
    } else {
      ApplyVersion1(root, controllers, group, machine);
    }
  }
  return machine;
}

LimitsConfig ResolveLimits(LimitsConfig limits, const MachineResources& machine) {
  const int num_processors = std::max(1, machine.num_processors);
  if (limits.max_concurrent_registrations == 0) limits.max_concurrent_registrations = num_processors;
  if (limits.max_threads_per_registration == 0) limits.max_threads_per_registration = num_processors;
  if (limits.memory_bytes == 0) {
    limits.memory_bytes = machine.memory_bytes == 0 ? kMemoryWhenUnknown : machine.memory_bytes / 2;
  }
  if (limits.cache_bytes == 0) limits.cache_bytes = limits.memory_bytes / 4;
  return limits;
}

LimitsConfig ResolveLimits(const LimitsConfig& limits) { return ResolveLimits(limits, ReadMachineResources()); }

}  // namespace curvereg::server
