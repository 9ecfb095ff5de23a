// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/trajectory_metrics.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/rigid_fit.h"

namespace curvereg {
namespace {

ErrorStatistics StatisticsOf(std::vector<double> errors) {
  if (errors.empty()) return {};
  std::sort(errors.begin(), errors.end());
  ErrorStatistics statistics;
  double sum = 0.0;
  double sum_of_squares = 0.0;
  for (const double error : errors) {
    sum += error;
    sum_of_squares += error * error;
  }
  const auto count = static_cast<double>(errors.size());
  const std::size_t middle = errors.size() / 2;
  statistics.rmse = std::sqrt(sum_of_squares / count);
  statistics.mean = sum / count;
  statistics.median = errors.size() % 2 == 1 ? errors[middle] : (errors[middle - 1] + errors[middle]) / 2.0;
  statistics.max = errors.back();
  return statistics;
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
  errors.rpe_m = StatisticsOf(std::move(steps_m));
  errors.rpe_rad = StatisticsOf(std::move(steps_rad));
  return errors;
}

}  // namespace curvereg
