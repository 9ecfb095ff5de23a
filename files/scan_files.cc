// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/scan_files.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "absl/strings/ascii.h"
#include "files/cloud_file.h"
#include "files/file_bytes.h"

namespace curvereg {
namespace {

namespace fs = std::filesystem;

// Text files beside the scans that are not scans.
bool IsNote(const fs::path& path) {
  constexpr std::array<std::string_view, 8> kNotes = {"readme",    "licen",     "poses",      "pairs",
                                                      "negatives", "strangers", "trajectory", "odometry"};
  const std::string stem = absl::AsciiStrToLower(path.stem().string());
  return std::any_of(kNotes.begin(), kNotes.end(), [&](std::string_view note) { return stem.starts_with(note); });
}

bool IsText(const std::string& path) { return absl::AsciiStrToLower(fs::path(path).extension().string()) == ".txt"; }

bool IsScan(const fs::directory_entry& entry, const std::string& except) {
  std::error_code error;
  const std::string name = entry.path().filename().string();
  if (name.starts_with('.') || !HasCloudEnding(name) || IsNote(name) || entry.is_directory(error)) return false;
  return except.empty() || !fs::equivalent(entry.path(), except, error);
}

}  // namespace

bool ComesBefore(const std::string& a, const std::string& b) {
  return std::pair(fs::path(a).stem().string(), a) < std::pair(fs::path(b).stem().string(), b);
}

absl::StatusOr<std::vector<std::string>> ScanFilesIn(const std::string& folder, const std::string& except) {
  std::error_code error;
  std::vector<std::string> files;
  fs::directory_iterator entry(folder, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    if (IsScan(*entry, except)) files.push_back(entry->path().string());
  }
  if (error) return ErrnoStatus(folder, "cannot read the folder", error.value());
  if (!std::all_of(files.begin(), files.end(), IsText)) std::erase_if(files, IsText);
  std::sort(files.begin(), files.end(), ComesBefore);
  return files;
}

}  // namespace curvereg
