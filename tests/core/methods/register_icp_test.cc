// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/methods/register_icp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/testing/matchers.h"
#include "tests/testing/scenes.h"

namespace curvereg {
namespace {

using ::testing::Contains;
using testing::IsNear;
using testing::IsOk;

struct Pair {
  std::unique_ptr<const PreparedScan> source;
  std::unique_ptr<const PreparedScan> target;
  RigidTransform T_target_source;
};

// Two scans of uneven ground, `distance_m` apart.
Pair GroundPair(double distance_m) {
  const RigidTransform T_world_source = testing::RoverPose(distance_m, 0.0, 0.02 * distance_m);
  const RigidTransform T_world_target = testing::RoverPose(0.0, 0.0, 0.0);
  const auto prepared = [](Scan scan) { return *PreparedScan::Create(std::make_shared<Scan>(std::move(scan))); };
  return {prepared(testing::BumpyGround(T_world_source, {.noise_seed = 1})),
          prepared(testing::BumpyGround(T_world_target, {.noise_seed = 2})), T_world_target.inverse() * T_world_source};
}

TEST(RegisterIcpTest, StartsFromIdentity) {
  const Pair pair = GroundPair(0.3);
  const auto result = RegisterIcp(*pair.source, *pair.target, {}, {});
  ASSERT_THAT(result, IsOk());
  EXPECT_TRUE(result->verdict.accepted);
  EXPECT_THAT(result->T_target_source, IsNear(pair.T_target_source, 0.03, 0.003));
}

TEST(RegisterIcpTest, StartsFromThePrior) {
  const Pair pair = GroundPair(4.0);
  RegistrationOptions options;
  options.prior.emplace();
  options.prior->T_target_source = testing::UprightPose(0.2, -0.2, 0.03, 0.1) * pair.T_target_source;
  const auto result = RegisterIcp(*pair.source, *pair.target, options, {});
  ASSERT_THAT(result, IsOk());
  EXPECT_TRUE(result->verdict.accepted);
  EXPECT_THAT(result->T_target_source, IsNear(pair.T_target_source, 0.03, 0.003));
}

TEST(RegisterIcpTest, AWrongStartIsNotAccepted) {
  const Pair pair = GroundPair(0.3);
  RegistrationOptions options;
  options.prior.emplace();
  options.prior->T_target_source = testing::UprightPose(8.0, -6.0, 2.0, 0.0) * pair.T_target_source;
  const auto result = RegisterIcp(*pair.source, *pair.target, options, {});
  ASSERT_THAT(result, IsOk());
  EXPECT_FALSE(result->verdict.accepted);
  EXPECT_FALSE(result->verdict.reasons.empty());
}

TEST(RegisterIcpTest, StopsWhenAsked) {
  const Pair pair = GroundPair(0.3);
  std::stop_source source;
  source.request_stop();
  Stop stop;
  stop.cancellation = source.get_token();
  EXPECT_THAT(RegisterIcp(*pair.source, *pair.target, {}, stop), testing::HasCode(absl::StatusCode::kCancelled));
  Stop late;
  late.deadline = std::chrono::steady_clock::now();
  const auto result = RegisterIcp(*pair.source, *pair.target, {}, late);
  ASSERT_THAT(result, IsOk());
  EXPECT_FALSE(result->verdict.accepted);
  EXPECT_THAT(result->verdict.reasons, Contains(Reason::kDeadline));
}

}  // namespace
}  // namespace curvereg
