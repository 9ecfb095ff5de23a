// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/dataset.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string_view>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "eval/dataset_text.h"
#include "eval/negative_pairs.h"
#include "files/file_bytes.h"
#include "files/scan_files.h"
#include "files/trajectory_file.h"

namespace curvereg {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMaxTextBytes = uint64_t{1} << 30;

using ScanIndex = std::map<std::string, std::size_t>;

absl::StatusOr<ScanIndex> ListScans(const std::vector<std::string>& paths, Dataset& dataset) {
  ScanIndex index;
  for (const std::string& path : paths) {
    const std::string name = fs::path(path).stem().string();
    if (!index.emplace(name, dataset.scan_names.size()).second) {
      return absl::InvalidArgumentError(absl::StrCat(path, ": another scan in the folder has this name too"));
    }
    dataset.scan_names.push_back(name);
    dataset.scan_paths.push_back(path);
  }
  dataset.T_world_scan.resize(dataset.scan_names.size());
  return index;
}

// A line per scan, in name order.
absl::Status FillStampedPoses(std::string_view text, Dataset& dataset) {
  const absl::StatusOr<std::vector<StampedPose>> poses = ParseTrajectory(text);
  if (!poses.ok()) return poses.status();
  if (poses->size() != dataset.scan_names.size()) {
    return absl::InvalidArgumentError(
        absl::StrCat("has ", poses->size(), " poses for ", dataset.scan_names.size(), " scans"));
  }
  for (std::size_t i = 0; i < poses->size(); ++i) dataset.T_world_scan[i] = (*poses)[i].T_world_scan;
  return absl::OkStatus();
}

// Poses of scans that the folder does not have are passed over: a part of a data set is one, too.
absl::Status FillNamedPoses(std::string_view text, const ScanIndex& index, Dataset& dataset) {
  const absl::StatusOr<std::vector<PoseLine>> poses = ParseNamedPoses(text);
  if (!poses.ok()) return poses.status();
  std::size_t num_found = 0;
  for (const PoseLine& pose : *poses) {
    const auto found = index.find(pose.name);
    if (found == index.end()) continue;
    std::optional<RigidTransform>& slot = dataset.T_world_scan[found->second];
    if (slot.has_value()) {
      return absl::InvalidArgumentError(absl::StrCat("line ", pose.line, ": second pose of scan ", pose.name));
    }
    slot = pose.T_world_scan;
    ++num_found;
  }
  if (num_found == 0) return absl::InvalidArgumentError("names no scan of the folder");
  return absl::OkStatus();
}

absl::Status FillPairs(std::string_view text, const PairSelection& selection, const ScanIndex& index,
                       Dataset& dataset) {
  absl::StatusOr<std::vector<PairLine>> pairs = ParsePairs(text);
  if (!pairs.ok()) return pairs.status();
  for (PairLine& line : *pairs) {
    for (const std::string& name : {line.pair.source, line.pair.target}) {
      if (index.contains(name)) continue;
      return absl::InvalidArgumentError(absl::StrCat("line ", line.line, ": no scan ", name, " in the folder"));
    }
    if (line.pair.overlap >= 0.0 && line.pair.overlap < selection.min_overlap) continue;
    dataset.pairs.push_back(std::move(line.pair));
  }
  return absl::OkStatus();
}

void PairConsecutiveScans(int every, Dataset& dataset) {
  for (std::size_t target = 0; target + static_cast<std::size_t>(every) < dataset.scan_names.size(); ++target) {
    const std::size_t source = target + static_cast<std::size_t>(every);
    const std::optional<RigidTransform>& T_world_target = dataset.T_world_scan[target];
    const std::optional<RigidTransform>& T_world_source = dataset.T_world_scan[source];
    if (!T_world_target.has_value() || !T_world_source.has_value()) continue;
    ScanPair pair;
    pair.source = dataset.scan_names[source];
    pair.target = dataset.scan_names[target];
    pair.T_target_source = T_world_target->inverse() * *T_world_source;
    dataset.pairs.push_back(std::move(pair));
  }
}

// Every N-th from the first.
void Thin(int take, std::vector<ScanPair>& pairs) {
  const auto step = static_cast<std::size_t>(take);
  std::vector<ScanPair> taken;
  for (std::size_t i = 0; i < pairs.size(); i += step) taken.push_back(std::move(pairs[i]));
  pairs = std::move(taken);
}

}  // namespace

absl::StatusOr<Dataset> LoadDataset(const std::string& folder, const PairSelection& selection) {
  if (selection.every < 1) return absl::InvalidArgumentError("every: must be at least 1");
  if (selection.take < 1) return absl::InvalidArgumentError("take: must be at least 1");
  const absl::StatusOr<std::vector<std::string>> paths = ScanFilesIn(folder);
  if (!paths.ok()) return paths.status();
  if (paths->empty()) return absl::InvalidArgumentError(absl::StrCat(folder, ": contains no scans"));
  Dataset dataset;
  dataset.folder = folder;
  const absl::StatusOr<ScanIndex> index = ListScans(*paths, dataset);
  if (!index.ok()) return index.status();

  const std::string poses_path = (fs::path(folder) / "poses.txt").string();
  const std::string pairs_path = (fs::path(folder) / "pairs.txt").string();
  const absl::StatusOr<FileBytes> poses = ReadFileBytes(poses_path, kMaxTextBytes);
  const absl::StatusOr<FileBytes> pairs = ReadFileBytes(pairs_path, kMaxTextBytes);
  if (!poses.ok() && !absl::IsNotFound(poses.status())) return poses.status();
  if (!pairs.ok() && !absl::IsNotFound(pairs.status())) return pairs.status();
  // Negative pairs are pairs, too.
  const bool has_truth = poses.ok() || pairs.ok() || !NegativePairsFile(folder).empty();
  if (selection.needs_truth && !has_truth) {
    return absl::NotFoundError(absl::StrCat(folder, ": has neither pairs.txt nor poses.txt"));
  }
  if (poses.ok()) {
    const absl::Status status = HasNamedPoses(poses->view()) ? FillNamedPoses(poses->view(), *index, dataset)
                                                             : FillStampedPoses(poses->view(), dataset);
    if (!status.ok()) return WithPath(poses_path, status);
  }
  if (!pairs.ok()) {
    PairConsecutiveScans(selection.every, dataset);
  } else if (const absl::Status status = FillPairs(pairs->view(), selection, *index, dataset); !status.ok()) {
    return WithPath(pairs_path, status);
  }
  Thin(selection.take, dataset.pairs);
  return dataset;
}

}  // namespace curvereg
