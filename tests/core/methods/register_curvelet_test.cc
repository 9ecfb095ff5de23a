// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/methods/register_curvelet.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/testing/matchers.h"
#include "tests/testing/scenes.h"

namespace curvereg {
namespace {

using ::testing::Contains;
using testing::IsNear;
using testing::IsOk;
using ::testing::Not;

// Precondition: the scan is valid.
std::unique_ptr<const PreparedScan> Prepared(Scan scan) {
  return *PreparedScan::Create(std::make_shared<Scan>(std::move(scan)));
}

const RigidTransform& SourcePose() {
  static const RigidTransform T_world_source = testing::RoverPose(3.0, 1.0, 0.4);
  return T_world_source;
}
const PreparedScan& Source() {
  static const auto scan = Prepared(testing::BumpyGround(SourcePose(), {.noise_seed = 1}));
  return *scan;
}
const PreparedScan& Target() {
  static const auto scan = Prepared(testing::BumpyGround(testing::RoverPose(0.0, 0.0, 0.0), {.noise_seed = 2}));
  return *scan;
}
RigidTransform Truth() { return testing::RoverPose(0.0, 0.0, 0.0).inverse() * SourcePose(); }

TEST(RegisterCurveletTest, EasyScansNeedOneRung) {
  const auto result = RegisterCurvelet(Source(), Target(), {}, {});
  ASSERT_THAT(result, IsOk());
  EXPECT_TRUE(result->verdict.accepted);
  EXPECT_THAT(result->T_target_source, IsNear(Truth(), 0.03, 0.003));
  EXPECT_EQ(result->evidence.num_attempts, 1);
  EXPECT_GT(result->evidence.num_source_keypoints, 50);
  EXPECT_GE(result->evidence.num_matches, result->evidence.num_inliers);
}

TEST(RegisterCurveletTest, HardScansEscalate) {
  const auto elsewhere = Prepared(testing::BumpyGround(testing::RoverPose(0.0, 0.0, 0.0, 1.6, 9), {.world_seed = 9}));
  const auto result = RegisterCurvelet(*elsewhere, Target(), {}, {});
  ASSERT_THAT(result, IsOk());
  EXPECT_FALSE(result->verdict.accepted);
  EXPECT_GE(result->evidence.num_attempts, 3);
}

TEST(RegisterCurveletTest, BothWaysAreInverse) {
  const auto forward = RegisterCurvelet(Source(), Target(), {}, {});
  const auto backward = RegisterCurvelet(Target(), Source(), {}, {});
  ASSERT_THAT(backward, IsOk());
  EXPECT_TRUE(backward->verdict.accepted);
  EXPECT_THAT(backward->T_target_source, IsNear(forward->T_target_source->inverse(), 0.01, 0.001));
}

TEST(RegisterCurveletTest, APriorWithoutCovarianceIsOneMoreHypothesis) {
  RegistrationOptions options;
  options.prior.emplace();
  options.prior->T_target_source = testing::UprightPose(20.0, -10.0, 2.0, 0.0);  // far off: must do no harm
  const auto result = RegisterCurvelet(Source(), Target(), options, {});
  ASSERT_THAT(result, IsOk());
  EXPECT_TRUE(result->verdict.accepted);
  EXPECT_THAT(result->T_target_source, IsNear(Truth(), 0.03, 0.003));
}

TEST(RegisterCurveletTest, PosesBeyondFiveSigmaOfThePriorAreNotConsidered) {
  RegistrationOptions options;
  options.prior.emplace();
  options.prior->covariance = 0.01 * Matrix6d::Identity();  // 0.1 rad, 0.1 m
  options.prior->T_target_source = Truth();
  options.prior->T_target_source.pretranslate(Eigen::Vector3d(0.2, 0.1, 0.0));
  const auto near = RegisterCurvelet(Source(), Target(), options, {});
  ASSERT_THAT(near, IsOk());
  EXPECT_TRUE(near->verdict.accepted);
  EXPECT_THAT(near->T_target_source, IsNear(Truth(), 0.03, 0.003));

  options.prior->T_target_source.pretranslate(Eigen::Vector3d(5.0, 0.0, 0.0));
  const auto far = RegisterCurvelet(Source(), Target(), options, {});
  ASSERT_THAT(far, IsOk());
  EXPECT_FALSE(far->verdict.accepted);
  if (far->T_target_source.has_value()) {
    EXPECT_THAT(far->T_target_source, Not(IsNear(Truth(), 2.0, 3.2)));
  }
}

TEST(RegisterCurveletTest, GravityDecidesTheVertical) {
  // Without overlap between their verticals the views could not match; gravity tells both.
  const RigidTransform T_world_target = testing::RoverPose(0.0, 0.0, 0.0);
  Scan source = Source().scan();
  Scan target = Target().scan();
  source.gravity = SourcePose().linear().transpose() * -Eigen::Vector3d::UnitZ();
  target.gravity = T_world_target.linear().transpose() * -Eigen::Vector3d::UnitZ();
  const auto result = RegisterCurvelet(*Prepared(source), *Prepared(target), {}, {});
  ASSERT_THAT(result, IsOk());
  EXPECT_TRUE(result->verdict.accepted);
  EXPECT_THAT(result->T_target_source, IsNear(Truth(), 0.03, 0.003));
}

TEST(RegisterCurveletTest, StopsWhenAsked) {
  std::stop_source source;
  source.request_stop();
  Stop cancelled;
  cancelled.cancellation = source.get_token();
  EXPECT_THAT(RegisterCurvelet(Source(), Target(), {}, cancelled), testing::HasCode(absl::StatusCode::kCancelled));
  Stop late;
  late.deadline = std::chrono::steady_clock::now();
  const auto result = RegisterCurvelet(Source(), Target(), {}, late);
  ASSERT_THAT(result, IsOk());
  EXPECT_FALSE(result->verdict.accepted);
  EXPECT_THAT(result->verdict.reasons, Contains(Reason::kDeadline));
}

}  // namespace
}  // namespace curvereg
