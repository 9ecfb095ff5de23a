// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/scan/free_space.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/testing/scenes.h"

namespace curvereg {
namespace {

using Answer = FreeSpace::Answer;
using Points = std::vector<Eigen::Vector3f>;

// A spherical wall of 10 m about the sensor, seen in all directions but those within 30 degrees of +z.
Points SphereWithAHole(int count) {
  Points points;
  for (int i = 0; i < count; ++i) {
    const double z = -1.0 + (1.0 + std::cos(std::numbers::pi / 6)) * (i + 0.5) / count;
    const double azimuth = 2.399963229728653 * i;  // golden angle: even everywhere
    const double across = std::sqrt(1.0 - z * z);
    points.emplace_back(
        Eigen::Vector3d(10 * across * std::cos(azimuth), 10 * across * std::sin(azimuth), 10 * z).cast<float>());
  }
  return points;
}

TEST(FreeSpaceTest, InFrontViolatesBehindIsUnknownOnTheSurfaceAgrees) {
  const FreeSpace free_space(SphereWithAHole(600000), {.margin_m = 0.25, .margin_per_metre = 0.02});
  testing::Random random(4);
  for (int i = 0; i < 500; ++i) {
    Eigen::Vector3f direction(static_cast<float>(random.Gaussian()), static_cast<float>(random.Gaussian()),
                              static_cast<float>(random.Gaussian()));
    direction.normalize();
    if (direction.z() > 0.8F) continue;
    // The margin at 10 m is 0.25 + 0.2 m.
    EXPECT_EQ(free_space.Ask(5.0F * direction), Answer::kViolates);
    EXPECT_EQ(free_space.Ask(9.4F * direction), Answer::kViolates);
    EXPECT_EQ(free_space.Ask(9.7F * direction), Answer::kAgrees);
    EXPECT_EQ(free_space.Ask(10.0F * direction), Answer::kAgrees);
    EXPECT_EQ(free_space.Ask(10.3F * direction), Answer::kAgrees);
    EXPECT_EQ(free_space.Ask(10.7F * direction), Answer::kUnseen);
    EXPECT_EQ(free_space.Ask(50.0F * direction), Answer::kUnseen);
  }
}

TEST(FreeSpaceTest, DirectionsNeverMeasuredAreUnknown) {
  const FreeSpace free_space(SphereWithAHole(600000));
  for (const float range : {1.0F, 10.0F, 100.0F}) {
    EXPECT_EQ(free_space.Ask({0.0F, 0.0F, range}), Answer::kUnseen);
    EXPECT_EQ(free_space.Ask({0.2F * range, -0.1F * range, range}), Answer::kUnseen);
  }
}

TEST(FreeSpaceTest, BetweenNearAndFarReturnsOfOneDirectionNothingContradicts) {
  const FreeSpace free_space({{5.0F, 0.0F, 0.0F}, {20.0F, 0.1F, 0.0F}});
  EXPECT_EQ(free_space.Ask({3.0F, 0.0F, 0.0F}), Answer::kViolates);
  EXPECT_EQ(free_space.Ask({12.0F, 0.0F, 0.0F}), Answer::kAgrees);
  EXPECT_EQ(free_space.Ask({30.0F, 0.0F, 0.0F}), Answer::kUnseen);
}

TEST(FreeSpaceTest, BeamsThatCameBackNowhereProveNothing) {
  // One return: 8 bins a side, so that the direction beside it belongs to a bin without returns of its own.
  const FreeSpace free_space({{5.0F, 0.1F, 0.1F}});
  EXPECT_EQ(free_space.Ask({2.0F, 0.04F, 0.04F}), Answer::kViolates);
  EXPECT_EQ(free_space.Ask({2.0F, 0.7F, 0.04F}), Answer::kUnseen);
  EXPECT_EQ(free_space.Ask({4.9F, 1.7F, 0.1F}), Answer::kAgrees);
  EXPECT_EQ(free_space.Ask({2.0F, 1.5F, 0.04F}), Answer::kUnseen);
}

TEST(FreeSpaceTest, MarginsAreThoseAsked) {
  const Points wall = SphereWithAHole(600000);
  const FreeSpace sharp(wall, {.margin_m = 0.01, .margin_per_metre = 0.0});
  EXPECT_EQ(sharp.Ask({9.9F, 0.0F, 0.0F}), Answer::kViolates);
  EXPECT_EQ(sharp.Ask({10.1F, 0.0F, 0.0F}), Answer::kUnseen);
  const FreeSpace wide(wall, {.margin_m = 0.0, .margin_per_metre = 0.5});
  EXPECT_EQ(wide.Ask({7.0F, 0.0F, 0.0F}), Answer::kAgrees);
  EXPECT_EQ(wide.Ask({6.0F, 0.0F, 0.0F}), Answer::kViolates);
}

TEST(FreeSpaceTest, AScanAgreesWithItself) {
  const Scan scan = testing::FurnishedHall(testing::UprightPose(0.5, 0.2, 0.3), {.num_columns = 360});
  const FreeSpace free_space(scan.points);
  const FreeSpaceAgreement agreement = AskAll(free_space, RigidTransform::Identity(), scan.points);
  EXPECT_EQ(agreement.agreeing, static_cast<int>(scan.points.size()));
  EXPECT_DOUBLE_EQ(agreement.Agreement(), 1.0);
  EXPECT_DOUBLE_EQ(agreement.Overlap(), 1.0);
}

TEST(FreeSpaceTest, ATrueMotionAgreesAndAWrongOneDoesNot) {
  const RigidTransform T_world_a = testing::UprightPose(0.5, 0.2, 0.3);
  const RigidTransform T_world_b = testing::UprightPose(-1.5, 0.6, 1.0);
  const Scan a = testing::FurnishedHall(T_world_a);
  const Scan b = testing::FurnishedHall(T_world_b);
  const FreeSpace free_space(a.points);
  const RigidTransform T_a_b = T_world_a.inverse() * T_world_b;
  RigidTransform T_wrong = T_a_b;
  T_wrong.pretranslate(Eigen::Vector3d(3.0, -2.0, 0.0));
  EXPECT_GT(AskAll(free_space, T_a_b, b.points).Agreement(), 0.98);
  EXPECT_GT(AskAll(free_space, T_a_b, b.points).Overlap(), 0.7);
  EXPECT_LT(AskAll(free_space, T_wrong, b.points).Agreement(), 0.9);
}

TEST(FreeSpaceTest, EmptyAndDegenerateInputKnowsNothing) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const Points nothing = {{0.0F, 0.0F, 0.0F}, {kNan, 1.0F, 1.0F}, {1.0F, kInfinity, 1.0F}};
  for (const FreeSpace& free_space : {FreeSpace(), FreeSpace(Points{}), FreeSpace(nothing)}) {
    EXPECT_EQ(free_space.Ask({1.0F, 2.0F, 3.0F}), Answer::kUnseen);
    EXPECT_EQ(free_space.Ask({0.0F, 0.0F, 0.0F}), Answer::kUnseen);
  }
  const FreeSpace wall(SphereWithAHole(60000));
  for (const Eigen::Vector3f& point : nothing) EXPECT_EQ(wall.Ask(point), Answer::kUnseen);
  const FreeSpaceAgreement none = AskAll(wall, RigidTransform::Identity(), {});
  EXPECT_EQ(none.Agreement(), 0.0);
  EXPECT_EQ(none.Overlap(), 0.0);
}

TEST(FreeSpaceTest, AgreementLeavesTheUnknownOutOverlapDoesNot) {
  const FreeSpaceAgreement agreement{.agreeing = 6, .violating = 2, .unknown = 4};
  EXPECT_DOUBLE_EQ(agreement.Agreement(), 0.75);
  EXPECT_DOUBLE_EQ(agreement.Overlap(), 0.5);
  const FreeSpaceAgreement unknown{.unknown = 4};
  EXPECT_EQ(unknown.Agreement(), 0.0);
  EXPECT_EQ(unknown.Overlap(), 0.0);
}

}  // namespace
}  // namespace curvereg
