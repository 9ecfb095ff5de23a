// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/loop_candidates.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "tests/testing/matchers.h"

namespace curvereg {
namespace {

using testing::HasCode;
using testing::IsOk;

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

using IsKept = std::function<bool(uint64_t number)>;

// Notes the pairs that could be tried.
TryPair NoteIn(std::vector<PairCandidate>& tried, const IsKept& is_kept) {
  return [&tried, is_kept](const PairCandidate& pair) -> absl::StatusOr<bool> {
    if (is_kept && !(is_kept(pair.source) && is_kept(pair.target))) return false;
    tried.push_back(pair);
    return true;
  };
}

std::vector<PairCandidate> Neighbours(const Traverse& traverse, uint64_t number, const TrackingOptions& options,
                                      const IsKept& is_kept = nullptr) {
  std::vector<PairCandidate> tried;
  EXPECT_THAT(TryNeighbours(traverse, number, options, NoteIn(tried, is_kept)), IsOk());
  return tried;
}

std::vector<PairCandidate> Loops(const Traverse& traverse, const TrackingOptions& options,
                                 const IsKept& is_kept = nullptr) {
  std::vector<PairCandidate> tried;
  EXPECT_THAT(TryLoops(traverse, options, NoteIn(tried, is_kept)), IsOk());
  return tried;
}

TEST(NeighbourCandidatesTest, NearestWithoutALinkFirst) {
  Traverse traverse = Circle(10);
  Link(traverse, 9, 8, true);
  Link(traverse, 9, 6, false);
  const std::vector<PairCandidate> candidates = Neighbours(traverse, 9, {});
  ASSERT_EQ(candidates.size(), 2U);  // 4 is 22.5 m away
  EXPECT_EQ(candidates[0].target, 7U);
  EXPECT_EQ(candidates[1].target, 5U);
  EXPECT_LT(candidates[0].distance_m, candidates[1].distance_m);
}

TEST(NeighbourCandidatesTest, OfTheOwnSegmentOnly) {
  Traverse traverse = Circle(10);
  for (size_t i = 0; i < 8; ++i) traverse.poses[i].segment = 1;
  const std::vector<PairCandidate> candidates = Neighbours(traverse, 9, {});
  ASSERT_EQ(candidates.size(), 1U);
  EXPECT_EQ(candidates[0].target, 8U);
}

TEST(NeighbourCandidatesTest, TheEarlierScanIsTheTarget) {
  for (const PairCandidate& candidate : Neighbours(Circle(10), 3, {})) {
    EXPECT_LT(candidate.target, candidate.source);
    EXPECT_TRUE(candidate.target == 3 || candidate.source == 3);
  }
}

TEST(NeighbourCandidatesTest, ScansThatAreNotKeptCountForNothing) {
  const std::vector<PairCandidate> candidates =
      Neighbours(Circle(10), 9, {}, [](uint64_t number) { return number != 8 && number != 6; });
  ASSERT_EQ(candidates.size(), 2U);
  EXPECT_EQ(candidates[0].target, 7U);
  EXPECT_EQ(candidates[1].target, 5U);
}

TEST(NeighbourCandidatesTest, AnErrorEndsTheSearch) {
  int num_asked = 0;
  const auto fail = [&](const PairCandidate&) -> absl::StatusOr<bool> {
    ++num_asked;
    return absl::DataLossError("broken");
  };
  EXPECT_THAT(TryNeighbours(Circle(10), 9, {}, fail), HasCode(absl::StatusCode::kDataLoss));
  EXPECT_THAT(TryLoops(Circle(2 * kLap), {}, fail), HasCode(absl::StatusCode::kDataLoss));
  EXPECT_EQ(num_asked, 2);
}

TEST(LoopCandidatesTest, NoneBeforeThePathComesBack) {
  EXPECT_TRUE(Loops(Circle(0), {}).empty());
  EXPECT_TRUE(Loops(Circle(kLap - 2), {}).empty());
}

TEST(LoopCandidatesTest, ScansOfTheNextLapNearestFirst) {
  const std::vector<PairCandidate> candidates = Loops(Circle(kLap + 1), {});
  ASSERT_FALSE(candidates.empty());
  EXPECT_EQ(candidates[0].source, kLap);
  EXPECT_EQ(candidates[0].target, 0U);
  EXPECT_NEAR(candidates[0].distance_m, 0.0, 1e-9);
  for (const PairCandidate& candidate : candidates) EXPECT_GE(candidate.source - candidate.target, 10U);
}

TEST(LoopCandidatesTest, SpreadAlongThePath) {
  TrackingOptions options;
  options.max_loop_candidates = 3;
  const std::vector<PairCandidate> candidates = Loops(Circle(2 * kLap), options);
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
  for (const PairCandidate& candidate : Loops(traverse, {})) {
    EXPECT_NE(candidate.source - candidate.target, kLap);
    EXPECT_TRUE(seen.emplace(candidate.source, candidate.target).second) << "twice";
  }
}

TEST(LoopCandidatesTest, ScansThatAreNotKeptCountForNothing) {
  TrackingOptions options;
  options.max_loop_candidates = 3;
  std::set<uint64_t> lost;  // the nearest pairs' scans
  for (const PairCandidate& candidate : Loops(Circle(2 * kLap), options)) lost.insert(candidate.source);
  ASSERT_EQ(lost.size(), 3U);
  const std::vector<PairCandidate> candidates =
      Loops(Circle(2 * kLap), options, [&](uint64_t number) { return !lost.contains(number); });
  ASSERT_EQ(candidates.size(), 3U);
  for (size_t i = 0; i < candidates.size(); ++i) {
    EXPECT_FALSE(lost.contains(candidates[i].source));
    // What is not kept does not stand for the scans around it.
    EXPECT_LT(candidates[i].distance_m, 1e-9) << "repeats none";
  }
}

TEST(LoopCandidatesTest, PairsThatRepeatAnotherComeLast) {
  TrackingOptions options;
  options.max_loop_candidates = 1000;
  const Traverse traverse = Circle(2 * kLap);
  const std::vector<PairCandidate> candidates = Loops(traverse, options);
  std::set<std::pair<uint64_t, uint64_t>> pairs;
  bool has_come_back = false;  // to near pairs, after far ones
  for (size_t i = 1; i < candidates.size(); ++i) {
    has_come_back = has_come_back || candidates[i].distance_m < candidates[i - 1].distance_m - 1.0;
    pairs.emplace(candidates[i].source, candidates[i].target);
  }
  EXPECT_TRUE(has_come_back);
  EXPECT_EQ(pairs.size() + 1, candidates.size()) << "each pair once";
  EXPECT_GT(candidates.size(), kLap);
}

// A gap of nothing is one of one scan: no pair of a scan with itself.
TEST(LoopCandidatesTest, ALeastGapOfNothing) {
  for (const int gap : {0, -5}) {
    TrackingOptions options;
    options.min_loop_gap = gap;
    options.max_loop_candidates = 1000;
    const std::vector<PairCandidate> candidates = Loops(Circle(5), options);
    EXPECT_EQ(candidates.size(), 7U);  // one and two scans apart: up to 10 m
    for (const PairCandidate& candidate : candidates) EXPECT_LT(candidate.target, candidate.source);
  }
}

// Every scan is within reach of every other: no more than a hundred pairs of each are held.
TEST(LoopCandidatesTest, AStandingRoverHasNotAllPairs) {
  Traverse traverse = Circle(1);
  traverse.poses.resize(500, traverse.poses[0]);
  for (uint64_t i = 0; i < traverse.poses.size(); ++i) traverse.poses[i].sequence_number = i;
  int num_asked = 0;
  const auto not_kept = [&](const PairCandidate&) -> absl::StatusOr<bool> {
    ++num_asked;
    return false;
  };
  EXPECT_THAT(TryLoops(traverse, {}, not_kept), IsOk());
  EXPECT_EQ(num_asked, 101 * 100 / 2 + (490 - 100) * 100);
  EXPECT_EQ(Loops(traverse, {}).size(), 20U);
}

TEST(LoopCandidatesTest, DoubtWidensTheReach) {
  Traverse traverse = Circle(kLap - 2);  // the last is 15 m short of the first
  EXPECT_TRUE(Loops(traverse, {}).empty());
  Matrix6d doubt = 1e-8 * Matrix6d::Identity();
  doubt.bottomRightCorner<3, 3>() = 4.0 * Eigen::Matrix3d::Identity();
  traverse.poses.back().covariance = doubt;
  const std::vector<PairCandidate> candidates = Loops(traverse, {});
  ASSERT_FALSE(candidates.empty());
  EXPECT_EQ(candidates[0].source, kLap - 3);
  EXPECT_EQ(candidates[0].target, 0U);
}

}  // namespace
}  // namespace curvereg
