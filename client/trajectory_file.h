// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Trajectory files: TUM ("timestamp tx ty tz qx qy qz qw", 9 or more decimals) and KITTI (12 numbers, row-major 3x4).
#ifndef CURVEREG_CLIENT_TRAJECTORY_FILE_H_
#define CURVEREG_CLIENT_TRAJECTORY_FILE_H_

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/rigid_transform.h"

namespace curvereg {

struct StampedPose {
  double timestamp_s = 0.0;
  RigidTransform T_world_scan = RigidTransform::Identity();
};

// TUM by default, KITTI when every line has 12 numbers; lines starting with '#' are comments.
// NOT_FOUND / INVALID_ARGUMENT (names file and line) / DATA_LOSS.
absl::StatusOr<std::vector<StampedPose>> ReadTrajectoryFile(const std::string& path);

enum class TrajectoryFormat { kTum, kKitti };

// Written whole or not at all. The frame is named in the header comment where the format has one (TUM).
absl::Status WriteTrajectoryFile(const std::string& path, const std::vector<StampedPose>& poses,
                                 TrajectoryFormat format = TrajectoryFormat::kTum);

}  // namespace curvereg

#endif  // CURVEREG_CLIENT_TRAJECTORY_FILE_H_
