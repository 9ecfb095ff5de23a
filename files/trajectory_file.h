// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Trajectory files: TUM ("timestamp tx ty tz qx qy qz qw", 9 or more decimals) and KITTI (12 numbers, row-major 3x4).
#ifndef CURVEREG_FILES_TRAJECTORY_FILE_H_
#define CURVEREG_FILES_TRAJECTORY_FILE_H_

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/rigid_transform.h"

namespace curvereg {

struct StampedPose {
  double timestamp_s = 0.0;
  RigidTransform T_world_scan = RigidTransform::Identity();
};

// TUM by default, KITTI when every line has 12 numbers; lines starting with '#' are comments.
// Columns are separated by spaces or tabs. Quaternions are normalised and rotation matrices orthonormalised; what is
// off by more than 0.01 is refused. A KITTI pose has the number of its line, from 0, for timestamp.
// NOT_FOUND / PERMISSION_DENIED / INVALID_ARGUMENT (names file and line; also a file without poses) / DATA_LOSS.
absl::StatusOr<std::vector<StampedPose>> ReadTrajectoryFile(const std::string& path);

// The same from the file's text; errors name the line only.
absl::StatusOr<std::vector<StampedPose>> ParseTrajectory(std::string_view text);

enum class TrajectoryFormat { kTum, kKitti };

// A file's text, as WriteTrajectoryFile writes it; `world`: what the world frame is, for the header comment.
// INVALID_ARGUMENT when a pose is not a finite rigid transform.
absl::StatusOr<std::string> TrajectoryText(const std::vector<StampedPose>& poses, TrajectoryFormat format,
                                           const std::string& world = "world");

// Written whole or not at all. TUM has 9 decimals of a second, 12 of a metre, 15 of the quaternion (qw >= 0); KITTI has
// 16 digits. INVALID_ARGUMENT when a pose is not a finite rigid transform; errors of the disk name the file. The frame
// is named in the header comment where the format has one (TUM).
absl::Status WriteTrajectoryFile(const std::string& path, const std::vector<StampedPose>& poses,
                                 TrajectoryFormat format = TrajectoryFormat::kTum);

}  // namespace curvereg

#endif  // CURVEREG_FILES_TRAJECTORY_FILE_H_
