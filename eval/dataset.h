// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A data set: a folder of scans in name order with truth, `pairs.txt` or `poses.txt`.
#ifndef CURVEREG_EVAL_DATASET_H_
#define CURVEREG_EVAL_DATASET_H_

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/rigid_transform.h"

namespace curvereg {

struct ScanPair {
  std::string source;  // scan name: file name without its ending
  std::string target;
  RigidTransform T_target_source = RigidTransform::Identity();  // truth
  double overlap = -1.0;  // share of the source seen by the target, in [0, 1]; -1 unknown
};

struct Dataset {
  std::string folder;
  std::vector<std::string> scan_names;                      // in name order
  std::vector<std::string> scan_paths;                      // same order
  std::vector<std::optional<RigidTransform>> T_world_scan;  // same order; nullopt where poses.txt has none
  std::vector<ScanPair> pairs;                              // what to register
};

struct PairSelection {
  int every = 1;             // with poses.txt: scan i + every registered onto scan i
  int take = 1;              // of the pairs so selected, every N-th from the first
  double min_overlap = 0.0;  // with pairs.txt: pairs of known overlap below it are left out
  bool needs_truth = true;   // NOT_FOUND without one of the files; false: then there are no pairs
};

// pairs.txt: per line `source target overlap ...` and, as the last 16 numbers, row-major T_target_source.
// poses.txt: TUM (sensor to world, one line per scan in name order) or lines `id` + 16 numbers, row-major T_world_scan.
// Pairs come from pairs.txt where it is, else from consecutive scans with poses. With neither file but negatives.txt
// (negatives.h) there are none. Errors name the file and line.
absl::StatusOr<Dataset> LoadDataset(const std::string& folder, const PairSelection& selection = {});

}  // namespace curvereg

#endif  // CURVEREG_EVAL_DATASET_H_
