// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/scan_folder.h"

#include <algorithm>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <system_error>

#include "files/scan_files.h"

namespace curvereg::cli {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPoll(100);

}  // namespace

void SleepOrStop(std::chrono::milliseconds time, const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any woken;
  std::unique_lock lock(mutex);
  woken.wait_for(lock, stop, time, [] { return false; });
}

absl::StatusOr<std::string> GrowingFolder::Look() {
  const absl::StatusOr<std::vector<std::string>> files = ScanFilesIn(folder_, options_.except);
  if (!files.ok()) return files.status();
  const Clock::time_point now = Clock::now();
  std::string first;
  for (const std::string& file : *files) {
    std::error_code error;
    const uintmax_t size = fs::file_size(file, error);
    if (error) continue;  // gone meanwhile
    auto [found, is_new] = seen_.try_emplace(file, Seen{size, now});
    Seen& seen = found->second;
    if (is_new && !last_given_.empty() && ComesBefore(file, last_given_)) {
      ++num_late_;
      seen.given = true;
    }
    if (seen.size != size) seen = {size, now, seen.given};
    if (!seen.given && first.empty()) first = file;
  }
  if (first.empty()) return first;
  Seen& seen = seen_[first];
  if (seen.size == 0 || now - seen.since < options_.settle_time) return std::string();
  seen.given = true;
  last_given_ = first;
  return first;
}

absl::StatusOr<std::string> GrowingFolder::Next(const std::stop_token& stop) {
  const Clock::time_point start = Clock::now();
  while (!stop.stop_requested()) {
    absl::StatusOr<std::string> file = Look();
    if (!file.ok() || !file->empty()) return file;
    const bool anything_coming = std::any_of(
        seen_.begin(), seen_.end(), [](const auto& seen) { return !seen.second.given && seen.second.size > 0; });
    if (options_.idle_end && !anything_coming && Clock::now() - start >= *options_.idle_end) break;
    SleepOrStop(kPoll, stop);
  }
  return std::string();
}

}  // namespace curvereg::cli
