// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/scan/leveling.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/rigid_transform.h"
#include "core/scan/scan.h"
#include "tests/testing/scenes.h"

namespace curvereg {
namespace {

// The vertical of a candidate, sensor frame.
Eigen::Vector3d Up(const LevelingCandidate& candidate) { return candidate.R_level_sensor.transpose().col(2); }

double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

void ExpectRotation(const Eigen::Matrix3d& R) {
  EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-9);
  EXPECT_NEAR(R.determinant(), 1.0, 1e-9);
}

// The verticals of a scan taken upright, then turned by `omega`, as the turned sensor would have recorded it.
std::vector<LevelingCandidate> VerticalsOfTurned(const Scan& scan, const Eigen::Vector3d& omega) {
  RigidTransform T_turned_scan = RigidTransform::Identity();
  T_turned_scan.linear() = RotationFromVector(omega);
  return FindVerticals(BuildVoxelMaps(TransformScan(scan, T_turned_scan).points), std::nullopt);
}

TEST(LevelingTest, FindsTheGroundOfATiltedPlane) {
  const Scan scan = testing::FlatGround(testing::UprightPose(0.0, 0.0, 0.0));
  for (const Eigen::Vector3d& omega :
       {Eigen::Vector3d(0.0, 0.0, 0.0), {0.3, 0.0, 0.0}, {0.5, -0.8, 0.1}, {0.0, 2.0, 0.0}, {3.1, 0.0, 0.0}}) {
    const auto candidates = VerticalsOfTurned(scan, omega);
    ASSERT_EQ(candidates.size(), 1U);
    ExpectRotation(candidates[0].R_level_sensor);
    // The ground lies below: up is the turned z axis, not its opposite.
    EXPECT_LT(AngleBetween(Up(candidates[0]), RotationFromVector(omega).col(2)), 0.002) << omega.transpose();
    EXPECT_GT(candidates[0].weight, 100.0);
  }
}

TEST(LevelingTest, FindsUnevenGroundWithinADegree) {
  const Scan scan = testing::BumpyGround(testing::UprightPose(0.0, 0.0, 0.0, testing::BumpyHeight(0.0, 0.0) + 1.6));
  for (const Eigen::Vector3d& omega : {Eigen::Vector3d(0.0, 0.0, 0.0), {0.5, -0.8, 0.1}}) {
    const auto candidates = VerticalsOfTurned(scan, omega);
    EXPECT_LT(AngleBetween(Up(candidates[0]), RotationFromVector(omega).col(2)), 0.04) << omega.transpose();
  }
}

TEST(LevelingTest, TheFloorsSideIsDownInAHall) {
  // Floor 1.2 m below, ceiling 2.8 m above; beams everywhere, so that both are seen.
  testing::ScannerOptions scanner;
  scanner.min_elevation_rad = -1.3;
  scanner.max_elevation_rad = 1.3;
  const Scan scan = testing::FurnishedHall(testing::UprightPose(0.5, 0.2, 0.3, 1.2), scanner);
  for (const Eigen::Vector3d& omega : {Eigen::Vector3d(0.0, 0.0, 0.0), {0.5, -0.8, 0.1}, {2.8, 0.2, 0.0}}) {
    const auto candidates = VerticalsOfTurned(scan, omega);
    bool found = false;
    for (const LevelingCandidate& candidate : candidates) {
      found = found || AngleBetween(Up(candidate), RotationFromVector(omega).col(2)) < 0.01;
    }
    EXPECT_TRUE(found) << omega.transpose();
  }
}

TEST(LevelingTest, CandidatesAreDistinctAndStrongestFirst) {
  testing::ScannerOptions scanner;
  scanner.min_elevation_rad = -1.3;
  scanner.max_elevation_rad = 1.3;
  const Scan scan = testing::FurnishedHall(testing::UprightPose(0.5, 0.2, 0.3), scanner);
  const LevelingOptions options{.min_relative_weight = 0.05, .max_candidates = 3};
  const auto candidates = FindVerticals(BuildVoxelMaps(scan.points), std::nullopt, options);
  ASSERT_EQ(candidates.size(), 3U);  // floor and ceiling, and the two directions of walls
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < i; ++j) {
      EXPECT_GE(candidates[j].weight, candidates[i].weight);
      EXPECT_NEAR(AngleBetween(Up(candidates[i]), Up(candidates[j])), std::numbers::pi / 2, 0.02);
    }
  }
  EXPECT_EQ(FindVerticals(BuildVoxelMaps(scan.points), std::nullopt, {.max_candidates = 1}).size(), 1U);
}

TEST(LevelingTest, GravityOverridesTheSurface) {
  const auto maps = BuildVoxelMaps(testing::FlatGround(testing::UprightPose(0.0, 0.0, 0.0)).points);
  for (const Eigen::Vector3d& down :
       {Eigen::Vector3d(1.0, 2.0, -3.0), {0.0, 0.0, -9.81}, {0.0, 0.0, 1e-3}, {3.7, 0.0, 0.0}}) {
    const auto candidates = FindVerticals(maps, down);
    ASSERT_EQ(candidates.size(), 1U);
    ExpectRotation(candidates[0].R_level_sensor);
    EXPECT_LT(AngleBetween(Up(candidates[0]), -down), 1e-9);
    EXPECT_EQ(candidates[0].weight, 0.0);
  }
}

TEST(LevelingTest, WithoutPlanesTheSensorsOwnAxis) {
  std::vector<Eigen::Vector3f> line;
  for (int i = 0; i < 1000; ++i) line.emplace_back(0.01F * static_cast<float>(i), 0.1F, 0.2F);
  const std::vector<Eigen::Vector3f> equal(1000, Eigen::Vector3f(1.0F, 2.0F, 3.0F));
  for (const auto& points : {std::vector<Eigen::Vector3f>{}, {Eigen::Vector3f(1.0F, 2.0F, 3.0F)}, line, equal}) {
    const auto candidates = FindVerticals(BuildVoxelMaps(points), std::nullopt);
    ASSERT_EQ(candidates.size(), 1U);
    EXPECT_TRUE(candidates[0].R_level_sensor.isIdentity(1e-12));
  }
  EXPECT_EQ(FindVerticals({}, std::nullopt).size(), 1U);
}

}  // namespace
}  // namespace curvereg
