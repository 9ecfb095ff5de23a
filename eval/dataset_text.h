// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The text of a data set's poses.txt and pairs.txt, apart from the folder it stands in.
#ifndef CURVEREG_EVAL_DATASET_TEXT_H_
#define CURVEREG_EVAL_DATASET_TEXT_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/rigid_transform.h"
#include "eval/dataset.h"

namespace curvereg {

// A pair and the line that it stands on, from 1.
struct PairLine {
  ScanPair pair;
  int64_t line = 0;
};

// A pose named by its scan.
struct PoseLine {
  std::string name;
  RigidTransform T_world_scan = RigidTransform::Identity();
  int64_t line = 0;
};

// Lines `source target overlap ...` whose last 16 numbers are T_target_source, row-major; with 18 columns the overlap
// is not known. INVALID_ARGUMENT names the line.
absl::StatusOr<std::vector<PairLine>> ParsePairs(std::string_view text);

// True when the first line of data has the 17 columns of `id` + 16 numbers, not those of a trajectory.
bool HasNamedPoses(std::string_view text);

// Lines `id` + 16 numbers, row-major T_world_scan. INVALID_ARGUMENT names the line.
absl::StatusOr<std::vector<PoseLine>> ParseNamedPoses(std::string_view text);

}  // namespace curvereg

#endif  // CURVEREG_EVAL_DATASET_TEXT_H_
