// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/trajectory_metrics.h"

#include <numeric>
#include <vector>

#include "core/pose/rigid_fit.h"
#include "eval/distribution.h"

namespace curvereg {
namespace {

ErrorStatistics StatisticsOf(const std::vector<double>& errors) {
  if (errors.empty()) return {};
  return {.rmse = RootMeanSquare(errors),
          .mean = std::accumulate(errors.begin(), errors.end(), 0.0) / static_cast<double>(errors.size()),
          .median = Quantile(errors, 0.5),
          .max = Quantile(errors, 1.0)};
}

RigidTransform FirstPoseAlignment(const PosePair& first) {
  return first.T_truth_scan * first.T_estimate_scan.inverse();
}

RigidTransform BestAlignment(std::span<const PosePair> poses) {
  std::vector<PointPair> places;
  places.reserve(poses.size());
  for (const PosePair& pose : poses) {
    places.push_back({.source = pose.T_estimate_scan.translation(), .target = pose.T_truth_scan.translation()});
  }
  const absl::StatusOr<RigidTransform> T_truth_estimate = FitRigidTransform(places);
  return T_truth_estimate.ok() ? *T_truth_estimate : FirstPoseAlignment(poses.front());
}

std::vector<double> PositionErrors(std::span<const PosePair> poses, const RigidTransform& T_truth_estimate) {
  std::vector<double> errors;
  errors.reserve(poses.size());
  for (const PosePair& pose : poses) {
    errors.push_back((T_truth_estimate * pose.T_estimate_scan.translation() - pose.T_truth_scan.translation()).norm());
  }
  return errors;
}

}  // namespace

absl::StatusOr<TrajectoryErrors> MeasureTrajectory(std::span<const PosePair> poses) {
  if (poses.empty()) return absl::InvalidArgumentError("a trajectory without poses has no errors");
  for (const PosePair& pose : poses) {
    if (!IsRigid(pose.T_estimate_scan) || !IsRigid(pose.T_truth_scan)) {
      return absl::InvalidArgumentError("a pose of the trajectory is not a rigid transform");
    }
  }
  TrajectoryErrors errors;
  errors.num_poses = static_cast<int>(poses.size());
  errors.ape_m = StatisticsOf(PositionErrors(poses, BestAlignment(poses)));
  const std::vector<double> drift = PositionErrors(poses, FirstPoseAlignment(poses.front()));
  errors.drift_at_end_m = drift.back();
  errors.drift_m = StatisticsOf(drift);
  std::vector<double> steps_m;
  std::vector<double> steps_rad;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const RigidTransform truth = poses[i - 1].T_truth_scan.inverse() * poses[i].T_truth_scan;
    const RigidTransform estimate = poses[i - 1].T_estimate_scan.inverse() * poses[i].T_estimate_scan;
    const TransformDifference error = Difference(truth, estimate);
    steps_m.push_back(error.translation_m);
    steps_rad.push_back(error.rotation_rad);
    errors.path_length_m += truth.translation().norm();
  }
  errors.rpe_m = StatisticsOf(steps_m);
  errors.rpe_rad = StatisticsOf(steps_rad);
  return errors;
}

}  // namespace curvereg
