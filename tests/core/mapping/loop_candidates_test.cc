// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/loop_candidates.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

namespace curvereg {
namespace {

// `num_laps` times round a circle of 20 scans, 5 m apart.
constexpr uint64_t kLap = 20;

Traverse Circle(uint64_t num_poses) {
  Traverse traverse;
  const double radius_m = 5.0 * kLap / (2.0 * std::numbers::pi);
  for (uint64_t i = 0; i < num_poses; ++i) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / kLap;
    TrajectoryPose pose;
    pose.sequence_number = i;
    pose.T_segment_scan.translation() = radius_m * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
    pose.covariance = 1e-8 * Matrix6d::Identity();
    traverse.poses.push_back(pose);
  }
  return traverse;
}

void Link(Traverse& traverse, uint64_t source, uint64_t target, bool accepted) {
  TraverseLink link{source, target, LinkKind::kTracking, {}};
  link.result.verdict.accepted = accepted;
  traverse.links.push_back(link);
}

TEST(NeighbourCandidatesTest, NearestWithoutALinkFirst) {
  Traverse traverse = Circle(10);
  Link(traverse, 9, 8, true);
  Link(traverse, 9, 6, false);
  const std::vector<PairCandidate> candidates = FindNeighbourCandidates(traverse, 9, {});
  ASSERT_EQ(candidates.size(), 2U);  // 4 is 22.5 m away
  EXPECT_EQ(candidates[0].target, 7U);
  EXPECT_EQ(candidates[1].target, 5U);
  EXPECT_LT(candidates[0].distance_m, candidates[1].distance_m);
}

TEST(NeighbourCandidatesTest, OfTheOwnSegmentOnly) {
  Traverse traverse = Circle(10);
  for (size_t i = 0; i < 8; ++i) traverse.poses[i].segment = 1;
  const std::vector<PairCandidate> candidates = FindNeighbourCandidates(traverse, 9, {});
  ASSERT_EQ(candidates.size(), 1U);
  EXPECT_EQ(candidates[0].target, 8U);
}

TEST(NeighbourCandidatesTest, TheEarlierScanIsTheTarget) {
  for (const PairCandidate& candidate : FindNeighbourCandidates(Circle(10), 3, {})) {
    EXPECT_LT(candidate.target, candidate.source);
    EXPECT_TRUE(candidate.target == 3 || candidate.source == 3);
  }
}

TEST(LoopCandidatesTest, NoneBeforeThePathComesBack) {
  EXPECT_TRUE(FindLoopCandidates(Circle(0), {}).empty());
  EXPECT_TRUE(FindLoopCandidates(Circle(kLap - 2), {}).empty());
}

TEST(LoopCandidatesTest, ScansOfTheNextLapNearestFirst) {
  const std::vector<PairCandidate> candidates = FindLoopCandidates(Circle(kLap + 1), {});
  ASSERT_FALSE(candidates.empty());
  EXPECT_EQ(candidates[0].source, kLap);
  EXPECT_EQ(candidates[0].target, 0U);
  EXPECT_NEAR(candidates[0].distance_m, 0.0, 1e-9);
  for (const PairCandidate& candidate : candidates) EXPECT_GE(candidate.source - candidate.target, 10U);
}

TEST(LoopCandidatesTest, SpreadAlongThePath) {
  TrackingOptions options;
  options.max_loop_candidates = 3;
  const std::vector<PairCandidate> candidates = FindLoopCandidates(Circle(2 * kLap), options);
  ASSERT_EQ(candidates.size(), 3U);
  for (size_t i = 0; i < candidates.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      const auto gap = std::abs(static_cast<int>(candidates[i].source) - static_cast<int>(candidates[j].source));
      EXPECT_GT(gap, 3) << i << " and " << j;
    }
  }
}

TEST(LoopCandidatesTest, WhatIsLinkedIsLeftOut) {
  Traverse traverse = Circle(2 * kLap);
  for (uint64_t i = kLap; i < 2 * kLap; ++i) Link(traverse, i, i - kLap, i % 2 == 0);
  std::set<std::pair<uint64_t, uint64_t>> seen;
  for (const PairCandidate& candidate : FindLoopCandidates(traverse, {})) {
    EXPECT_NE(candidate.source - candidate.target, kLap);
    EXPECT_TRUE(seen.emplace(candidate.source, candidate.target).second) << "twice";
  }
}

TEST(LoopCandidatesTest, DoubtWidensTheReach) {
  Traverse traverse = Circle(kLap - 2);  // the last is 15 m short of the first
  EXPECT_TRUE(FindLoopCandidates(traverse, {}).empty());
  Matrix6d doubt = 1e-8 * Matrix6d::Identity();
  doubt.bottomRightCorner<3, 3>() = 4.0 * Eigen::Matrix3d::Identity();
  traverse.poses.back().covariance = doubt;
  const std::vector<PairCandidate> candidates = FindLoopCandidates(traverse, {});
  ASSERT_FALSE(candidates.empty());
  EXPECT_EQ(candidates[0].source, kLap - 3);
  EXPECT_EQ(candidates[0].target, 0U);
}

}  // namespace
}  // namespace curvereg
