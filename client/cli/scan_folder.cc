// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/cli/scan_folder.h"

#include <algorithm>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "client/files/cloud_file.h"

namespace curvereg::cli {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPoll(100);

// Text files beside the scans of a data set that are not scans.
bool IsNote(const std::string& name) {
  return name.starts_with("poses") || name.starts_with("pairs") || name.starts_with("strangers") ||
         name.starts_with("trajectory") || name.starts_with("odometry") || name.starts_with("README");
}

bool IsSameFile(const fs::path& path, const std::string& other) {
  std::error_code error;
  return !other.empty() && fs::equivalent(path, other, error);
}

}  // namespace

void SleepOrStop(std::chrono::milliseconds time, const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any woken;
  std::unique_lock lock(mutex);
  woken.wait_for(lock, stop, time, [] { return false; });
}

absl::StatusOr<std::vector<std::string>> ScanFilesIn(const std::string& folder, const std::string& except) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    if (fs::exists(folder, error)) return absl::InvalidArgumentError(absl::StrCat(folder, ": is not a folder"));
    return absl::NotFoundError(absl::StrCat(folder, ": no such folder"));
  }
  std::vector<std::string> files;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with('.') || !HasCloudEnding(name) || IsNote(name) || IsSameFile(entry->path(), except)) continue;
    files.push_back(entry->path().string());
  }
  if (error) return absl::PermissionDeniedError(absl::StrCat(folder, ": cannot be read: ", error.message()));
  std::sort(files.begin(), files.end());
  return files;
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
    if (is_new && file < last_given_) {
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
