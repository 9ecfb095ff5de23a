// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/merged_map.h"

#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace curvereg {
namespace {

Scan ScanOf(std::vector<Eigen::Vector3f> points) { return {.points = std::move(points), .gravity = std::nullopt}; }

TEST(MergedMap, OneMeanPointPerCell) {
  MergedMap map(1.0);
  map.Add(ScanOf({{0.25f, 0.5f, 0.5f}, {0.75f, 0.5f, 0.5f}, {1.5f, 0.5f, -0.5f}}), RigidTransform::Identity());
  const Scan points = map.Points();
  ASSERT_EQ(points.points.size(), 2u);
  EXPECT_TRUE(points.points[0].isApprox(Eigen::Vector3f(0.5f, 0.5f, 0.5f)));
  EXPECT_TRUE(points.points[1].isApprox(Eigen::Vector3f(1.5f, 0.5f, -0.5f)));
}

TEST(MergedMap, ScansMeetInTheWorldFrame) {
  MergedMap map(0.5);
  map.Add(ScanOf({{1.1f, 0.1f, 0.1f}}), RigidTransform::Identity());
  map.Add(ScanOf({{0.1f, 0.1f, 0.1f}}), RigidTransform(Eigen::Translation3d(1.0, 0.0, 0.0)));
  ASSERT_EQ(map.Points().points.size(), 1u);
  EXPECT_NEAR(map.Points().points[0].x(), 1.1f, 1e-6f);
}

TEST(MergedMap, LeavesOutWhatHasNoPlace) {
  MergedMap map(0.1);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  map.Add(ScanOf({{nan, 0, 0}, {INFINITY, 0, 0}, {1e9f, 0, 0}, {-1e9f, 0, 0}}), RigidTransform::Identity());
  EXPECT_TRUE(map.Points().points.empty());
  EXPECT_TRUE(MergedMap(1.0).Points().points.empty());
}

TEST(MergedMap, CellsDifferInEveryAxisAndSign) {
  MergedMap map(1.0);
  Scan corners;
  for (int i = 0; i < 8; ++i) {
    corners.points.emplace_back(i & 1 ? 0.5f : -0.5f, i & 2 ? 0.5f : -0.5f, i & 4 ? 0.5f : -0.5f);
  }
  map.Add(corners, RigidTransform::Identity());
  EXPECT_EQ(map.Points().points.size(), 8u);
}

TEST(MergedMap, AddingTwiceChangesNothing) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<float> coordinate(-20.0f, 20.0f);
  Scan scan;
  for (int i = 0; i < 5000; ++i) scan.points.emplace_back(coordinate(generator), coordinate(generator), 0.0f);
  MergedMap once(0.7), twice(0.7);
  once.Add(scan, RigidTransform::Identity());
  twice.Add(scan, RigidTransform::Identity());
  twice.Add(scan, RigidTransform::Identity());
  const Scan a = once.Points(), b = twice.Points();
  ASSERT_EQ(a.points.size(), b.points.size());
  EXPECT_LT(a.points.size(), scan.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) EXPECT_LT((a.points[i] - b.points[i]).norm(), 1e-5f);
}

}  // namespace
}  // namespace curvereg
