// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/operations/process_statistics.h"

#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

namespace curvereg::server {
namespace {

// The fields of /proc/self/stat after the program's name, which may hold blanks and parentheses: [0] is the state,
// field 3 of proc(5).
std::vector<std::string> StatFields() {
  std::ifstream file("/proc/self/stat");
  std::ostringstream text;
  text << file.rdbuf();
  const std::string line = text.str();
  const std::size_t name_end = line.rfind(')');
  if (name_end == std::string::npos) return {};
  std::istringstream fields(line.substr(name_end + 1));
  return {std::istream_iterator<std::string>(fields), {}};
}

double BootTimeSeconds() {
  std::ifstream file("/proc/stat");
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string name;
    double value = 0.0;
    if (words >> name >> value && name == "btime") return value;
  }
  return 0.0;
}

double Number(const std::vector<std::string>& fields, std::size_t proc_field) {
  const std::size_t index = proc_field - 3;
  double value = 0.0;
  if (index < fields.size()) std::istringstream(fields[index]) >> value;
  return value;
}

double CpuSeconds() {
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) != 0) return 0.0;
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double CountOpenFiles() {
  std::error_code error;
  std::filesystem::directory_iterator entry("/proc/self/fd", error);
  double count = 0.0;
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) ++count;
  return count > 0.0 ? count - 1.0 : 0.0;  // without the one that lists them
}

}  // namespace

ProcessStatistics ReadProcessStatistics() {
  const std::vector<std::string> fields = StatFields();
  ProcessStatistics statistics;
  statistics.cpu_seconds = CpuSeconds();
  statistics.num_threads = Number(fields, 20);
  statistics.start_time_seconds = BootTimeSeconds() + Number(fields, 22) / static_cast<double>(sysconf(_SC_CLK_TCK));
  statistics.virtual_bytes = Number(fields, 23);
  statistics.resident_bytes = Number(fields, 24) * static_cast<double>(sysconf(_SC_PAGESIZE));
  statistics.num_open_files = CountOpenFiles();
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) == 0) statistics.max_open_files = static_cast<double>(limit.rlim_cur);
  return statistics;
}

}  // namespace curvereg::server
