// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Poses of a traverse as poses of a file.
#ifndef CURVEREG_CLI_TRAVERSE_TRAJECTORY_H_
#define CURVEREG_CLI_TRAVERSE_TRAJECTORY_H_

#include <vector>

#include "core/mapping/trajectory.h"
#include "files/trajectory_file.h"

namespace curvereg::cli {

// With the most poses, the first of several; 0 without any.
int LargestSegment(const std::vector<TrajectoryPose>& poses);

// The poses of one segment. Their times where all of the segment have one, else sequence numbers: the two do not mix.
std::vector<StampedPose> PosesOf(const std::vector<TrajectoryPose>& poses, int segment);

}  // namespace curvereg::cli

#endif  // CURVEREG_CLI_TRAVERSE_TRAJECTORY_H_
