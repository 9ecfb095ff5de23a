// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/negative_pairs.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace curvereg {
namespace {

namespace fs = std::filesystem;

constexpr char kFile[] = "negatives.txt";
constexpr char kOldFile[] = "strangers.txt";

}  // namespace

std::string NegativePairsFile(const std::string& folder) {
  for (const char* name : {kFile, kOldFile}) {
    const fs::path path = fs::path(folder) / name;
    std::error_code error;
    if (fs::exists(path, error)) return path.string();
  }
  return "";
}

bool IsOldNegativePairsFile(const std::string& path) { return fs::path(path).filename() == kOldFile; }

absl::StatusOr<std::vector<NegativePair>> LoadNegativePairs(const Dataset& dataset) {
  const std::string path = NegativePairsFile(dataset.folder);
  if (path.empty()) return std::vector<NegativePair>{};
  std::ifstream file(path);
  if (!file) return absl::PermissionDeniedError(absl::StrCat(path, ": cannot be opened for reading"));

  std::vector<NegativePair> pairs;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const std::string content = line.substr(0, line.find('#'));
    const std::vector<std::string> words = absl::StrSplit(content, absl::ByAnyChar(" \t\r"), absl::SkipEmpty());
    if (words.empty()) continue;
    if (words.size() != 2) {
      return absl::InvalidArgumentError(absl::StrCat(path, ":", number, ": expected two scan names"));
    }
    for (const std::string& name : words) {
      if (std::find(dataset.scan_names.begin(), dataset.scan_names.end(), name) == dataset.scan_names.end()) {
        return absl::InvalidArgumentError(absl::StrCat(path, ":", number, ": no scan is named ", name));
      }
    }
    pairs.push_back({.source = words[0], .target = words[1]});
  }
  return pairs;
}

}  // namespace curvereg
