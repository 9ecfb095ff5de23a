// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/trajectory_metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace curvereg {
namespace {

RigidTransform Pose(double x, double y, double yaw_rad) {
  RigidTransform T = RigidTransform::Identity();
  T.linear() = RotationFromVector({0.0, 0.0, yaw_rad});
  T.translation() = Eigen::Vector3d(x, y, 0.0);
  return T;
}

std::vector<PosePair> Arc() {
  std::vector<PosePair> poses;
  for (int i = 0; i < 8; ++i) {
    const RigidTransform T = Pose(10.0 * std::cos(0.2 * i), 10.0 * std::sin(0.2 * i), 0.2 * i);
    poses.push_back({.T_estimate_scan = T, .T_truth_scan = T});
  }
  return poses;
}

TEST(MeasureTrajectoryTest, AnotherWorldFrameIsNoError) {
  std::vector<PosePair> poses = Arc();
  const RigidTransform T_other_truth = Pose(100.0, -7.0, 2.0);
  for (PosePair& pose : poses) pose.T_estimate_scan = T_other_truth * pose.T_estimate_scan;
  const absl::StatusOr<TrajectoryErrors> errors = MeasureTrajectory(poses);
  ASSERT_TRUE(errors.ok()) << errors.status();
  EXPECT_EQ(errors->num_poses, 8);
  EXPECT_LT(errors->ape_m.max, 1e-9);
  EXPECT_LT(errors->drift_m.max, 1e-9);
  EXPECT_LT(errors->rpe_m.max, 1e-9);
  EXPECT_LT(errors->rpe_rad.max, 1e-7);
  EXPECT_NEAR(errors->path_length_m, 7 * 20.0 * std::sin(0.1), 1e-9);
}

TEST(MeasureTrajectoryTest, OneWrongStepShowsOnceInRpeAndEverAfterInDrift) {
  std::vector<PosePair> poses = Arc();
  // From pose 4 on the estimate lies 0.3 m off.
  for (std::size_t i = 4; i < poses.size(); ++i) {
    poses[i].T_estimate_scan = Eigen::Translation3d(0.0, 0.0, 0.3) * poses[i].T_estimate_scan;
  }
  const absl::StatusOr<TrajectoryErrors> errors = MeasureTrajectory(poses);
  ASSERT_TRUE(errors.ok()) << errors.status();
  EXPECT_NEAR(errors->rpe_m.max, 0.3, 1e-12);
  EXPECT_NEAR(errors->rpe_m.rmse, 0.3 / std::sqrt(7.0), 1e-12);
  EXPECT_NEAR(errors->rpe_m.median, 0.0, 1e-12);
  EXPECT_NEAR(errors->rpe_rad.max, 0.0, 1e-7);
  EXPECT_NEAR(errors->drift_at_end_m, 0.3, 1e-12);
  EXPECT_NEAR(errors->drift_m.rmse, 0.3 * std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(errors->drift_m.mean, 0.15, 1e-12);
  EXPECT_NEAR(errors->drift_m.median, 0.15, 1e-12);
  EXPECT_LT(errors->ape_m.rmse, errors->drift_m.rmse);  // the best alignment spreads it
  EXPECT_GT(errors->ape_m.rmse, 0.0);
}

TEST(MeasureTrajectoryTest, ApeIsTheLeastOverAllAlignments) {
  std::vector<PosePair> poses = Arc();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    poses[i].T_estimate_scan.translation() += 0.05 * Eigen::Vector3d(std::sin(3.0 * static_cast<double>(i)), 0.0, 1.0);
  }
  const absl::StatusOr<TrajectoryErrors> best = MeasureTrajectory(poses);
  ASSERT_TRUE(best.ok());
  for (const double turn : {-0.01, 0.01}) {
    double sum = 0.0;
    for (const PosePair& pose : poses) {
      const Eigen::Vector3d turned = Pose(0.0, 0.0, turn) * pose.T_estimate_scan.translation();
      sum += (turned - pose.T_truth_scan.translation()).squaredNorm();
    }
    EXPECT_GT(std::sqrt(sum / static_cast<double>(poses.size())), best->ape_m.rmse);
  }
}

TEST(MeasureTrajectoryTest, OnOneLineTheFirstPoseIsAlignedToItsTruth) {
  std::vector<PosePair> poses;
  for (int i = 0; i < 5; ++i) {
    poses.push_back({.T_estimate_scan = Pose(1.1 * i, 0.0, 0.5), .T_truth_scan = Pose(i, 0.0, 0.5)});
  }
  const absl::StatusOr<TrajectoryErrors> errors = MeasureTrajectory(poses);
  ASSERT_TRUE(errors.ok());
  EXPECT_NEAR(errors->ape_m.max, 0.4, 1e-12);
  EXPECT_NEAR(errors->drift_at_end_m, 0.4, 1e-12);
}

TEST(MeasureTrajectoryTest, OnePoseHasNoSteps) {
  const std::vector<PosePair> poses(1);
  const absl::StatusOr<TrajectoryErrors> errors = MeasureTrajectory(poses);
  ASSERT_TRUE(errors.ok());
  EXPECT_EQ(errors->ape_m.rmse, 0.0);
  EXPECT_TRUE(std::isnan(errors->rpe_m.rmse));
}

TEST(MeasureTrajectoryTest, RefusesWhatIsNoTrajectory) {
  EXPECT_TRUE(absl::IsInvalidArgument(MeasureTrajectory({}).status()));
  std::vector<PosePair> poses = Arc();
  poses[3].T_estimate_scan.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(absl::IsInvalidArgument(MeasureTrajectory(poses).status()));
}

}  // namespace
}  // namespace curvereg
