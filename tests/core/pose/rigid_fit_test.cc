// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pose/rigid_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace curvereg {
namespace {

RigidTransform Pose(const Eigen::Vector3d& omega, const Eigen::Vector3d& translation) {
  RigidTransform T = RigidTransform::Identity();
  T.linear() = RotationFromVector(omega);
  T.translation() = translation;
  return T;
}

std::vector<PointPair> PairsUnder(const RigidTransform& T_target_source, const std::vector<Eigen::Vector3d>& points) {
  std::vector<PointPair> pairs;
  for (const Eigen::Vector3d& point : points) pairs.push_back({point, T_target_source * point});
  return pairs;
}

// Points in general position, without a symmetry.
std::vector<Eigen::Vector3d> Cloud(int count) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) {
    points.emplace_back(7.0 * std::sin(1.3 * i), 5.0 * std::cos(2.1 * i + 0.4), 2.0 * std::sin(0.7 * i * i));
  }
  return points;
}

double SumOfSquares(const RigidTransform& T, const std::vector<PointPair>& pairs) {
  double sum = 0.0;
  for (const PointPair& pair : pairs) sum += (T * pair.source - pair.target).squaredNorm();
  return sum;
}

TEST(RigidFitTest, RecoversExactMotionsAtAnyAngle) {
  for (const double angle : {0.0, 1e-9, 0.01, 1.0, 3.0, std::numbers::pi}) {
    const RigidTransform truth = Pose(angle * Eigen::Vector3d(0.48, -0.6, 0.64), {12.0, -7.0, 0.5});
    const auto fit = FitRigidTransform(PairsUnder(truth, Cloud(20)));
    ASSERT_TRUE(fit.ok()) << fit.status();
    EXPECT_LT((fit->matrix() - truth.matrix()).norm(), 1e-12) << angle;
    EXPECT_TRUE(IsRigid(*fit, 1e-12));
  }
}

TEST(RigidFitTest, ThreePairsAndPointsOnAPlaneAreEnough) {
  const RigidTransform truth = Pose({0.3, -1.2, 2.0}, {1.0, 2.0, 3.0});
  for (const std::vector<Eigen::Vector3d>& points :
       {std::vector<Eigen::Vector3d>{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}},
        std::vector<Eigen::Vector3d>{{0, 0, 5}, {1, 0, 5}, {0, 2, 5}, {3, 3, 5}, {-2, 1, 5}}}) {
    const auto fit = FitRigidTransform(PairsUnder(truth, points));
    ASSERT_TRUE(fit.ok()) << fit.status();
    EXPECT_LT((fit->matrix() - truth.matrix()).norm(), 1e-12);
  }
}

TEST(RigidFitTest, FarFromTheOriginOnlyTheSizeOfTheCoordinatesLimits) {
  const RigidTransform truth = Pose({0.1, 0.2, 0.3}, {3.0, 0.0, 0.0});
  std::vector<Eigen::Vector3d> points = Cloud(20);
  for (Eigen::Vector3d& point : points) point += Eigen::Vector3d(1e5, -1e5, 0.0);
  const auto fit = FitRigidTransform(PairsUnder(truth, points));
  ASSERT_TRUE(fit.ok());
  EXPECT_LT((fit->linear() - truth.linear()).norm(), 1e-10);
  EXPECT_LT(((*fit * points[3]) - (truth * points[3])).norm(), 1e-8);
}

TEST(RigidFitTest, NeverAReflection) {
  std::vector<PointPair> pairs;
  for (const Eigen::Vector3d& point : Cloud(12)) {
    pairs.push_back({point, Eigen::Vector3d(point.x(), point.y(), -point.z())});
  }
  const auto fit = FitRigidTransform(pairs);
  ASSERT_TRUE(fit.ok()) << fit.status();
  EXPECT_TRUE(IsRigid(*fit, 1e-12));
}

TEST(RigidFitTest, NoOtherMotionFitsNoisyPairsBetter) {
  const RigidTransform truth = Pose({0.2, -0.1, 0.9}, {4.0, 1.0, -2.0});
  std::vector<PointPair> pairs = PairsUnder(truth, Cloud(30));
  for (size_t i = 0; i < pairs.size(); ++i) {
    const auto t = static_cast<double>(i);
    pairs[i].target += 0.1 * Eigen::Vector3d(std::sin(9.0 * t), std::cos(7.0 * t), std::sin(5.0 * t + 1.0));
  }
  const RigidTransform fit = *FitRigidTransform(pairs);
  const double best = SumOfSquares(fit, pairs);
  EXPECT_LT(best, SumOfSquares(truth, pairs));
  for (int axis = 0; axis < 6; ++axis) {
    for (const double step : {-1e-3, 1e-3}) {
      Vector6d delta = Vector6d::Zero();
      delta[axis] = step;
      EXPECT_GT(SumOfSquares(TransformFromVector(delta) * fit, pairs), best) << axis << " " << step;
    }
  }
}

TEST(RigidFitTest, ExchangingTheSidesGivesTheInverse) {
  std::vector<PointPair> pairs = PairsUnder(Pose({0.5, 0.5, -1.0}, {1.0, -2.0, 0.0}), Cloud(10));
  pairs[4].target.x() += 0.3;
  std::vector<PointPair> exchanged;
  for (const PointPair& pair : pairs) exchanged.push_back({pair.target, pair.source});
  const RigidTransform both = *FitRigidTransform(exchanged) * *FitRigidTransform(pairs);
  EXPECT_LT((both.matrix() - Eigen::Matrix4d::Identity()).norm(), 1e-12);
}

TEST(RigidFitTest, TooLittleToFitIsRefused) {
  EXPECT_EQ(FitRigidTransform({}).status().code(), absl::StatusCode::kInvalidArgument);
  const RigidTransform truth = Pose({0.3, 0.0, 1.0}, {1.0, 0.0, 2.0});
  EXPECT_EQ(FitRigidTransform(PairsUnder(truth, {{0, 0, 0}, {1, 0, 0}})).status().code(),
            absl::StatusCode::kInvalidArgument);
  const std::vector<Eigen::Vector3d> equal(5, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(FitRigidTransform(PairsUnder(truth, equal)).status().code(), absl::StatusCode::kFailedPrecondition);
  std::vector<Eigen::Vector3d> line;
  for (int i = 0; i < 9; ++i) line.emplace_back(0.1 * i, 0.7 * i + 1.0, -0.3 * i);
  EXPECT_EQ(FitRigidTransform(PairsUnder(truth, line)).status().code(), absl::StatusCode::kFailedPrecondition);
  std::vector<PointPair> half_line = PairsUnder(truth, Cloud(9));
  for (size_t i = 0; i < half_line.size(); ++i) half_line[i].target = line[i];
  EXPECT_EQ(FitRigidTransform(half_line).status().code(), absl::StatusCode::kFailedPrecondition);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    std::vector<PointPair> pairs = PairsUnder(truth, Cloud(9));
    pairs[3].target.y() = bad;
    EXPECT_EQ(FitRigidTransform(pairs).status().code(), absl::StatusCode::kInvalidArgument);
  }
}

}  // namespace
}  // namespace curvereg
