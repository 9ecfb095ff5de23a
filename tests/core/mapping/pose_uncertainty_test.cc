// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/pose_uncertainty.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "sim/random.h"
#include "tests/testing/matchers.h"

namespace curvereg {
namespace {

using testing::IsNear;

RigidTransform SomeTransform(double scale) {
  Vector6d delta;
  delta << 0.3, -0.5, 1.2, 4.0, -3.0, 0.5;
  return TransformFromVector(scale * delta);
}

Matrix6d SomeCovariance(double scale) {
  Matrix6d root = Matrix6d::Zero();
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j <= i; ++j) root(i, j) = scale * (i == j ? 1.0 + 0.2 * i : 0.3 - 0.1 * j);
  }
  return root * root.transpose();
}

// A transform off by an error drawn from the covariance.
RigidTransform Drawn(const Prior& prior, sim::RandomStream& random) {
  Vector6d normal;
  for (int i = 0; i < 6; ++i) normal[i] = random.Normal();
  const Matrix6d root = Eigen::LLT<Matrix6d>(*prior.covariance).matrixL();
  return TransformFromVector(root * normal) * prior.T_target_source;
}

Vector6d ErrorOf(const RigidTransform& T_found, const RigidTransform& T_true) {
  const RigidTransform off = T_found * T_true.inverse();
  Vector6d error;
  error << VectorFromRotation(off.linear()), off.translation();
  return error;
}

TEST(ChainedTest, CovarianceIsThatOfManyDraws) {
  const Prior first{SomeTransform(1.0), SomeCovariance(1e-3)};
  const Prior second{SomeTransform(-0.7), SomeCovariance(2e-3)};
  const Prior chained = Chained(first, second);
  EXPECT_THAT(chained.T_target_source, IsNear(first.T_target_source * second.T_target_source, 1e-12, 1e-12));
  ASSERT_TRUE(chained.covariance.has_value());
  sim::RandomStream random(5);
  constexpr int kNumDraws = 20'000;
  Matrix6d sum = Matrix6d::Zero();
  for (int i = 0; i < kNumDraws; ++i) {
    const Vector6d error = ErrorOf(Drawn(first, random) * Drawn(second, random), chained.T_target_source);
    sum += error * error.transpose();
  }
  EXPECT_LT((sum / kNumDraws - *chained.covariance).norm(), 0.05 * chained.covariance->norm());
}

TEST(ChainedTest, UnknownStaysUnknown) {
  const Prior known{SomeTransform(1.0), SomeCovariance(1e-3)};
  const Prior unknown{SomeTransform(1.0), std::nullopt};
  EXPECT_FALSE(Chained(known, unknown).covariance.has_value());
  EXPECT_FALSE(Chained(unknown, known).covariance.has_value());
}

TEST(PositionCovarianceTest, RotationMovesWhatIsFarAway) {
  Matrix6d covariance = Matrix6d::Zero();
  covariance(2, 2) = 1e-4;  // yaw of 10 mrad
  RigidTransform T = RigidTransform::Identity();
  T.translation() = Eigen::Vector3d(100.0, 0.0, 0.0);
  const Eigen::Matrix3d position = PositionCovariance(T, covariance);
  EXPECT_NEAR(position(1, 1), 1.0, 1e-9);
  EXPECT_NEAR(position(0, 0), 0.0, 1e-9);
}

TrajectoryPose PoseAt(uint64_t number, const Prior& prior) {
  TrajectoryPose pose;
  pose.sequence_number = number;
  pose.T_segment_scan = prior.T_target_source;
  pose.covariance = prior.covariance;
  return pose;
}

TEST(RelativePoseTest, OfNeighboursIsWhatCameBetween) {
  const Prior motion{SomeTransform(0.4), SomeCovariance(1e-2)};
  const Prior before{SomeTransform(2.0), SomeCovariance(1e-1)};
  const RelativePoseOptions options{.shared_gap = 3, .least_sigma_rad = 1e-4, .least_sigma_m = 1e-4};
  const Prior relative = RelativePose(PoseAt(7, before), PoseAt(8, Chained(before, motion)), options);
  EXPECT_THAT(relative.T_target_source, IsNear(motion.T_target_source, 1e-12, 1e-12));
  ASSERT_TRUE(relative.covariance.has_value());
  EXPECT_LT((*relative.covariance - *motion.covariance).norm(), 1e-2 * motion.covariance->norm());
}

TEST(RelativePoseTest, FarApartInSequenceErrorsAdd) {
  const Prior first{SomeTransform(1.0), SomeCovariance(1e-2)};
  const Prior second{SomeTransform(-1.0), SomeCovariance(1e-2)};
  const Prior far = RelativePose(PoseAt(0, first), PoseAt(100, second));
  const Prior near = RelativePose(PoseAt(0, first), PoseAt(1, second));
  ASSERT_TRUE(far.covariance.has_value());
  ASSERT_TRUE(near.covariance.has_value());
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix6d>(*far.covariance - *near.covariance).eigenvalues()[0], 0.0);
  // Equal errors cancel; what is left is the least that is ever believed.
  EXPECT_NEAR((*near.covariance)(0, 0), 0.02 * 0.02, 1e-9);
  EXPECT_NEAR((*near.covariance)(3, 3), 0.2 * 0.2, 1e-9);
}

TEST(RelativePoseTest, OfUnknownPosesIsAGuess) {
  const Prior relative = RelativePose(PoseAt(0, {SomeTransform(1.0), std::nullopt}),
                                      PoseAt(1, {SomeTransform(2.0), SomeCovariance(1e-2)}));
  EXPECT_FALSE(relative.covariance.has_value());
  EXPECT_THAT(relative.T_target_source, IsNear(SomeTransform(1.0).inverse() * SomeTransform(2.0), 1e-12, 1e-12));
}

TEST(LinkCovarianceTest, NeverSmallerThanIsBelieved) {
  const PoseGraphOptions options;
  RegistrationResult result;
  result.covariance = 1e-12 * Matrix6d::Identity();
  result.T_target_source = Eigen::Translation3d(5.0, 0.0, 0.0);
  const Matrix6d near = LinkCovariance(result, options);
  EXPECT_NEAR(std::sqrt(near(0, 0)), options.least_sigma_rad, 1e-6);
  EXPECT_NEAR(std::sqrt(near(5, 5)), options.least_sigma_m, 1e-6);
  result.T_target_source->translation() = Eigen::Vector3d(20.0, 0.0, 0.0);
  EXPECT_NEAR(std::sqrt(LinkCovariance(result, options)(5, 5)), 2.0 * options.least_sigma_m, 1e-6);
  result.covariance = Matrix6d::Identity();
  EXPECT_NEAR(LinkCovariance(result, options)(0, 0), 1.0, 1e-3);
}

}  // namespace
}  // namespace curvereg
