// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pose/refinement.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "core/scan/scan.h"
#include "tests/testing/matchers.h"
#include "tests/testing/same_bytes.h"
#include "tests/testing/scenes.h"

namespace curvereg {
namespace {

using testing::IsNear;

constexpr LevelRange kAllLevels{0, 2};

struct Pair {
  std::vector<VoxelMap> source;
  std::vector<VoxelMap> target;
  RigidTransform T_target_source;
};

Pair GroundPair() {
  const RigidTransform T_world_source = testing::RoverPose(3.0, 1.0, 0.4);
  const RigidTransform T_world_target = testing::RoverPose(0.0, 0.0, 0.0);
  return {BuildVoxelMaps(testing::BumpyGround(T_world_source, {.noise_seed = 1}).points),
          BuildVoxelMaps(testing::BumpyGround(T_world_target, {.noise_seed = 2}).points),
          T_world_target.inverse() * T_world_source};
}

Pair HallPair() {
  const RigidTransform T_world_source = testing::UprightPose(-1.5, 0.6, 1.0, 1.9);
  const RigidTransform T_world_target = testing::UprightPose(0.5, 0.2, 0.3, 1.6);
  return {BuildVoxelMaps(testing::FurnishedHall(T_world_source, {.noise_seed = 1}).points),
          BuildVoxelMaps(testing::FurnishedHall(T_world_target, {.noise_seed = 2}).points),
          T_world_target.inverse() * T_world_source};
}

Pair PlainPair() {
  const RigidTransform T_world_source = testing::UprightPose(2.0, 1.0, 0.4);
  const RigidTransform T_world_target = testing::UprightPose(0.0, 0.0, 0.0);
  return {BuildVoxelMaps(testing::FlatGround(T_world_source, {.noise_seed = 1}).points),
          BuildVoxelMaps(testing::FlatGround(T_world_target, {.noise_seed = 2}).points),
          T_world_target.inverse() * T_world_source};
}

RigidTransform Disturbed(const RigidTransform& T, double size) {
  const Vector6d delta = (Vector6d() << 0.02, -0.03, 0.05, 0.3, -0.2, 0.15).finished();
  return TransformFromVector(size * delta) * T;
}

SurfaceFit Refine(const Pair& pair, const RigidTransform& T_start) {
  return RefineOnLevels(pair.source, pair.target, kAllLevels, T_start, {}, {});
}

TEST(RefineOnLevelsTest, FindsTheMotionOnUnevenGround) {
  const Pair pair = GroundPair();
  const SurfaceFit fit = Refine(pair, Disturbed(pair.T_target_source, 1.0));
  EXPECT_THAT(fit.T_target_source, IsNear(pair.T_target_source, 0.03, 0.003));
  EXPECT_GT(fit.num_pairs, 500);
  EXPECT_GE(fit.num_surfels, fit.num_pairs);
  EXPECT_GT(fit.inlier_fraction, 0.8);
  EXPECT_LE(fit.inlier_fraction, 1.0);
  EXPECT_GT(fit.residual_rms_m, 0.0);
  EXPECT_LT(fit.residual_rms_m, 0.1);
  EXPECT_LE(fit.residual_median_m, fit.residual_p90_m);
  EXPECT_LE(fit.iterations, RefinementOptions{}.max_iterations);
}

TEST(RefineOnLevelsTest, FindsTheMotionInAHall) {
  const Pair pair = HallPair();
  const SurfaceFit fit = Refine(pair, Disturbed(pair.T_target_source, 1.0));
  EXPECT_THAT(fit.T_target_source, IsNear(pair.T_target_source, 0.01, 0.002));
}

TEST(RefineOnLevelsTest, AScanLiesOnItselfExactly) {
  const Pair pair = GroundPair();
  const SurfaceFit fit =
      RefineOnLevels(pair.source, pair.source, kAllLevels, Disturbed(RigidTransform::Identity(), 0.3), {}, {});
  EXPECT_THAT(fit.T_target_source, IsNear(RigidTransform::Identity(), 1e-3, 1e-4));
  EXPECT_LT(fit.residual_median_m, 1e-3);
}

TEST(RefineOnLevelsTest, AWrongPoseFitsWorse) {
  const Pair pair = GroundPair();
  const SurfaceFit right = Refine(pair, pair.T_target_source);
  const SurfaceFit wrong = Refine(pair, testing::UprightPose(-6.0, 5.0, 2.0, 0.0) * pair.T_target_source);
  EXPECT_GT(wrong.residual_rms_m, 2.0 * right.residual_rms_m);
  EXPECT_LT(wrong.inlier_fraction, right.inlier_fraction);
}

TEST(RefineOnLevelsTest, OnAPlainHeightAndTiltAreFoundAndTheRestIsNotThrownAway) {
  const Pair pair = PlainPair();
  const RigidTransform T_start =
      TransformFromVector((Vector6d() << 0.02, -0.02, 0.05, 0.4, -0.3, 0.1).finished()) * pair.T_target_source;
  const SurfaceFit fit = Refine(pair, T_start);
  const RigidTransform T_error = fit.T_target_source * pair.T_target_source.inverse();
  // Height, roll and pitch come from the plane.
  EXPECT_LT(VectorFromRotation(T_error.linear()).head<2>().norm(), 0.002);
  EXPECT_NEAR(T_error.translation().z(), 0.0, 0.01);
  // Yaw and place do not: noise may move them a little, but nothing throws them away.
  EXPECT_LT(std::abs(VectorFromRotation(T_error.linear()).z()), 0.3);
  EXPECT_LT((fit.T_target_source.translation() - T_start.translation()).head<2>().norm(), 1.0);
}

TEST(RefineOnLevelsTest, WithoutPairsThePoseStays) {
  const Pair pair = GroundPair();
  RigidTransform T_far = pair.T_target_source;
  T_far.pretranslate(Eigen::Vector3d(500.0, 0.0, 0.0));
  const SurfaceFit fit = Refine(pair, T_far);
  EXPECT_LT(fit.num_pairs, 6);
  EXPECT_EQ(fit.T_target_source.matrix(), T_far.matrix());
  EXPECT_FALSE(fit.converged);
  const auto nothing = BuildVoxelMaps({});
  const SurfaceFit empty = RefineOnLevels(nothing, nothing, kAllLevels, T_far, {}, {});
  EXPECT_EQ(empty.num_pairs, 0);
  EXPECT_EQ(empty.num_surfels, 0);
  EXPECT_EQ(empty.T_target_source.matrix(), T_far.matrix());
}

TEST(RefineOnLevelsTest, StopsWhenAsked) {
  const Pair pair = GroundPair();
  const RigidTransform T_start = Disturbed(pair.T_target_source, 1.0);
  std::stop_source source;
  source.request_stop();
  Stop stop;
  stop.cancellation = source.get_token();
  const SurfaceFit cancelled = RefineOnLevels(pair.source, pair.target, kAllLevels, T_start, {}, stop);
  EXPECT_THAT(cancelled.T_target_source, IsNear(T_start, 1e-9, 1e-7));
  EXPECT_FALSE(cancelled.converged);
  Stop deadline;
  deadline.deadline = std::chrono::steady_clock::now();
  const SurfaceFit late = RefineOnLevels(pair.source, pair.target, kAllLevels, T_start, {}, deadline);
  EXPECT_THAT(late.T_target_source, IsNear(T_start, 1e-9, 1e-7));
}

TEST(RefineOnLevelsTest, InformationIsSymmetricAndPositive) {
  const SurfaceFit fit = Refine(GroundPair(), GroundPair().T_target_source);
  EXPECT_LT((fit.information - fit.information.transpose()).norm(), 1e-9 * fit.information.norm());
  EXPECT_LT((fit.cross_information - fit.cross_information.transpose()).norm(), 1e-9 * fit.information.norm());
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix6d>(fit.information).eigenvalues()[0], 0.0);
  for (int i = 0; i < 6; ++i) {
    const Vector6d direction = Vector6d::Unit(i);
    const double variance = fit.NoiseVarianceAlong(direction);
    EXPECT_GT(variance, 0.0);
    EXPECT_NEAR(fit.NoiseVarianceAlong(-2.0 * direction), 16.0 * variance, 1e-6 * variance);
  }
}

TEST(RefineOnLevelsTest, PoseAndResidualsDoNotNeedTheInformation) {
  const Pair pair = GroundPair();
  RefinementOptions options;
  options.measure_information = false;
  const SurfaceFit fast = RefineOnLevels(pair.source, pair.target, kAllLevels, pair.T_target_source, options, {});
  const SurfaceFit full = Refine(pair, pair.T_target_source);
  EXPECT_EQ(fast.T_target_source.matrix(), full.T_target_source.matrix());
  EXPECT_EQ(fast.residual_rms_m, full.residual_rms_m);
  EXPECT_EQ(fast.inlier_fraction, full.inlier_fraction);
}

TEST(RefineOnLevelsTest, SameBytesAtAnyThreadCount) {
  const Pair pair = GroundPair();
  testing::ExpectSameBytesAtAnyThreadCount([&](testing::ByteLog& log) {
    const SurfaceFit fit = Refine(pair, Disturbed(pair.T_target_source, 1.0));
    log.Add(fit.T_target_source.data(), 16);
    log.Add(fit.information.data(), 36);
    log.Add(fit.residual_rms_m);
  });
}

TEST(PoseCovarianceTest, CoversTheErrorAndKnowsTheFlatPlainsDirections) {
  const Pair pair = GroundPair();
  const SurfaceFit fit = Refine(pair, pair.T_target_source);
  const Matrix6d covariance = PoseCovariance(fit);
  EXPECT_LT((covariance - covariance.transpose()).norm(), 1e-9 * covariance.norm());
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix6d>(covariance).eigenvalues()[0], 0.0);
  Vector6d error;
  error << VectorFromRotation(fit.T_target_source.linear() * pair.T_target_source.linear().transpose()),
      fit.T_target_source.translation() - pair.T_target_source.translation();
  // Normalised squared error of six degrees of freedom: 6 on average, 22 in one of a thousand.
  EXPECT_LT(error.dot(covariance.ldlt().solve(error)), 60.0);
  EXPECT_LT(std::sqrt(covariance(5, 5)), 0.05);

  const Pair plain = PlainPair();
  const Matrix6d of_plain = PoseCovariance(Refine(plain, plain.T_target_source));
  EXPECT_GT(of_plain(3, 3), 25.0 * of_plain(5, 5));
  EXPECT_GT(of_plain(4, 4), 25.0 * of_plain(5, 5));
}

TEST(PoseCovarianceTest, WithoutInformationItIsLargeButFinite) {
  const Matrix6d covariance = PoseCovariance(SurfaceFit{});
  EXPECT_TRUE(covariance.allFinite());
  for (int i = 0; i < 6; ++i) EXPECT_GT(covariance(i, i), 1e6);
}

}  // namespace
}  // namespace curvereg
