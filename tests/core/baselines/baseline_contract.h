// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What both baselines promise (core/baselines/baseline.h). A test file names its baseline:
// INSTANTIATE_TEST_SUITE_P(FpfhSacIa, BaselineContract, ::testing::Values(&RegisterFpfhSacIa));
#ifndef CURVEREG_TESTS_CORE_BASELINES_BASELINE_CONTRACT_H_
#define CURVEREG_TESTS_CORE_BASELINES_BASELINE_CONTRACT_H_

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <limits>
#include <thread>

#include "core/baselines/baseline.h"
#include "tests/core/baselines/bumpy_ground.h"

namespace curvereg::testing {

using RegisterFunction = absl::StatusOr<BaselineResult> (*)(const Scan&, const Scan&, const BaselineOptions&);

class BaselineContract : public ::testing::TestWithParam<RegisterFunction> {
 protected:
  static absl::StatusOr<BaselineResult> Register(const Scan& source, const Scan& target,
                                                 const BaselineOptions& options) {
    return GetParam()(source, target, options);
  }
  // The paper's thresholds are as wide as this ground, and its 20-fold randomness needs far more than 100 samples.
  static BaselineOptions OptionsForASmallScene() {
    BaselineOptions options;
    options.normal_radius_m = 0.6;
    options.correspondence_randomness = 2;
    options.icp_max_correspondence_m = 1.0;
    options.ransac_threshold_m = 0.5;
    options.max_iterations = 300;
    return options;
  }
  static RigidTransform Source() { return SensorPose(1.2, -0.7, 0.15); }  // T_world_source
  static RigidTransform Target() { return SensorPose(0.0, 0.0, 0.0); }    // T_world_target
};

TEST_P(BaselineContract, RecoversAMotion) {
  const auto result = Register(BumpyScan(Source(), 1), BumpyScan(Target(), 2), OptionsForASmallScene());
  ASSERT_TRUE(result.ok()) << result.status();
  ASSERT_TRUE(result->T_target_source.has_value());
  EXPECT_TRUE(result->converged);
  EXPECT_FALSE(result->failure.has_value());
  const TransformDifference error = Difference(*result->T_target_source, Target().inverse() * Source());
  EXPECT_LT(error.translation_m, 0.05);
  EXPECT_LT(error.rotation_rad, 0.01);
  EXPECT_TRUE(IsRigid(*result->T_target_source));
  EXPECT_GT(result->num_source_keypoints, 10);
  EXPECT_GT(result->num_target_keypoints, 10);
  EXPECT_GT(result->num_inliers, 4000);
  EXPECT_GT(result->num_iterations, 0);
  EXPECT_GT(result->residual_rmse_m, 0.0);
  EXPECT_LT(result->residual_rmse_m, 0.3);
}

TEST_P(BaselineContract, GivesTheSameBytesForTheSameSeed) {
  const Scan source = BumpyScan(Source(), 1, 2000);
  const Scan target = BumpyScan(Target(), 2, 2000);
  BaselineOptions options;
  options.max_iterations = 3;  // far from converged: every draw still shows in the pose
  const auto pose = [&](uint64_t seed) {
    options.seed = seed;
    return Register(source, target, options)->T_target_source->matrix().eval();
  };
  const Eigen::Matrix4d first = pose(7);
  EXPECT_EQ(first, pose(7));
  EXPECT_NE(first, pose(8));
}

TEST_P(BaselineContract, ConcurrentCallsDoNotDisturbEachOther) {
  const Scan source = BumpyScan(Source(), 1, 2000);
  const Scan target = BumpyScan(Target(), 2, 2000);
  BaselineOptions options;
  options.max_iterations = 5;
  const Eigen::Matrix4d alone = Register(source, target, options)->T_target_source->matrix();
  Eigen::Matrix4d beside;
  {
    const std::jthread other([&] { (void)Register(target, source, options); });
    beside = Register(source, target, options)->T_target_source->matrix();
  }
  EXPECT_EQ(alone, beside);
}

TEST_P(BaselineContract, SkipsPointsThatAreNotFinite) {
  const Scan target = BumpyScan(Target(), 2, 2000);
  const Scan source = BumpyScan(Source(), 1, 2000);
  Scan with_gaps;
  for (const Eigen::Vector3f& point : source.points) {
    with_gaps.points.push_back(point);
    with_gaps.points.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F);
  }
  EXPECT_EQ(Register(source, target, {})->T_target_source->matrix(),
            Register(with_gaps, target, {})->T_target_source->matrix());
}

TEST_P(BaselineContract, ThinsByVoxels) {
  BaselineOptions options;
  options.voxel_size_m = 0.5;
  const auto result = Register(BumpyScan(Source(), 1, 20000), BumpyScan(Target(), 2, 20000), options);
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_TRUE(result->T_target_source.has_value());
  EXPECT_LT(result->num_inliers, 4000);  // 20 m x 20 m of voxels of 0.5 m, some bumps being steep
  EXPECT_GT(result->num_inliers, 1000);
}

TEST_P(BaselineContract, StopsSoonAfterACancellation) {
  std::stop_source cancel;
  BaselineOptions options;
  options.stop.cancellation = cancel.get_token();
  options.feature_radius_m = 3.0;  // slow: seconds if nobody stopped it
  const Scan source = BumpyScan(Source(), 1, 20000);
  const Scan target = BumpyScan(Target(), 2, 20000);
  std::chrono::steady_clock::time_point requested;
  std::jthread canceller([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    requested = std::chrono::steady_clock::now();
    cancel.request_stop();
  });
  const auto result = Register(source, target, options);
  const auto ended = std::chrono::steady_clock::now();
  canceller.join();
  EXPECT_EQ(result.status().code(), absl::StatusCode::kCancelled);
  // Takes a few milliseconds; the rest is room for a busy machine.
  EXPECT_LT(std::chrono::duration<double>(ended - requested).count(), 0.25);
}

TEST_P(BaselineContract, SaysThatTimeRanOut) {
  BaselineOptions options;
  options.stop.deadline = std::chrono::steady_clock::now();
  const auto result = Register(BumpyScan(Source(), 1), BumpyScan(Target(), 2), options);
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_FALSE(result->T_target_source.has_value());
  EXPECT_EQ(result->failure, Reason::kDeadline);
}

TEST_P(BaselineContract, HasNoPoseForScatteredPoints) {
  Scan scattered;  // 10 m apart: no point has a neighbour to take a normal from
  for (int i = 0; i < 200; ++i) {
    scattered.points.emplace_back(10.0F * static_cast<float>(i % 20), 10.0F * static_cast<float>(i / 20), 0.1F);
  }
  const auto result = Register(scattered, BumpyScan(Target(), 2, 2000), {});
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_FALSE(result->T_target_source.has_value());
  EXPECT_EQ(result->failure, Reason::kTooFewFeatures);
}

TEST_P(BaselineContract, RefusesScansThatCannotBeUsed) {
  const Scan good = BumpyScan(Target(), 2, 500);
  const Scan empty;
  Scan one_place;
  one_place.points.assign(500, Eigen::Vector3f(1.0F, 2.0F, 3.0F));
  for (const Scan& bad : {empty, one_place}) {
    EXPECT_EQ(Register(bad, good, {}).status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_EQ(Register(good, bad, {}).status().code(), absl::StatusCode::kInvalidArgument);
  }
}

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_CORE_BASELINES_BASELINE_CONTRACT_H_
