// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Errors of a whole trajectory against the truth, as the tool evo defines them: APE after alignment (also called ATE,
// absolute trajectory error), RPE from pose to pose [J. Sturm et al., "A benchmark for the evaluation of RGB-D SLAM
// systems", IROS 2012, eq. (1) and (4)].
#ifndef CURVEREG_EVAL_TRAJECTORY_METRICS_H_
#define CURVEREG_EVAL_TRAJECTORY_METRICS_H_

#include <limits>
#include <span>

#include "absl/status/statusor.h"
#include "core/base/rigid_transform.h"

namespace curvereg {

// Poses of the same scan in the estimate and in the truth; their world frames need not be the same.
struct PosePair {
  RigidTransform T_estimate_scan = RigidTransform::Identity();
  RigidTransform T_truth_scan = RigidTransform::Identity();
};

struct ErrorStatistics {
  double rmse = std::numeric_limits<double>::quiet_NaN();
  double mean = std::numeric_limits<double>::quiet_NaN();
  double median = std::numeric_limits<double>::quiet_NaN();
  double max = std::numeric_limits<double>::quiet_NaN();
};

struct TrajectoryErrors {
  int num_poses = 0;
  // `evo_ape tum truth estimate --align`: positions after the rigid transform (no scale) that best aligns the estimate
  // to the truth [Umeyama 1991]. Fewer than three poses, or poses on one line: with the first pose aligned to its
  // truth.
  ErrorStatistics ape_m;
  // `evo_ape ... --align_origin`: positions with the first pose aligned to its truth. What the operator at the landing
  // site sees.
  ErrorStatistics drift_m;
  double drift_at_end_m = std::numeric_limits<double>::quiet_NaN();
  double path_length_m = 0.0;  // of the truth
  // `evo_rpe ... --delta 1 --delta_unit f --all_pairs`: of the motion from each pose to the next.
  ErrorStatistics rpe_m;
  ErrorStatistics rpe_rad;
};

// INVALID_ARGUMENT: no poses, or one that is not a finite rigid transform. One pose: no RPE (NaN).
absl::StatusOr<TrajectoryErrors> MeasureTrajectory(std::span<const PosePair> poses);

}  // namespace curvereg

#endif  // CURVEREG_EVAL_TRAJECTORY_METRICS_H_
