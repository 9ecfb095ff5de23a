// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "core/mapping/find_links.h"
#include "core/mapping/traverse_changes.h"
#include "tests/testing/matchers.h"
#include "tests/testing/traverses.h"

namespace curvereg {
namespace {

using testing::DriveScans;
using testing::HasCode;
using testing::IsNear;
using testing::IsOk;

// A drive round and round: seven scans to a lap.
class FindLinksTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    sim::SimulationOptions options = testing::SmallDrive(9);
    options.traverse.shape = sim::TraverseShape::kLoop;
    options.traverse.loop_radius_m = 6.0;
    drive_ = std::make_unique<DriveScans>(*sim::Simulation::Create(options));
    tracked_ = std::make_unique<Traverse>(testing::TrackDrive(*drive_));
  }
  static void TearDownTestSuite() {
    drive_.reset();
    tracked_.reset();
  }

  static void ExpectTrue(const TraverseLink& link) {
    EXPECT_LT(link.target, link.source);
    EXPECT_TRUE(link.result.verdict.accepted) << link.source << " on " << link.target;
    EXPECT_THAT(link.result.T_target_source, IsNear(drive_->TrueMotion(link.target, link.source), 0.05, 0.005));
  }

  // The drive as two segments: it broke off before scan `number`.
  static Traverse Broken(uint64_t number) {
    Traverse traverse = *tracked_;
    std::erase_if(traverse.links,
                  [&](const TraverseLink& link) { return link.source >= number && link.target < number; });
    const RigidTransform T_new_old = traverse.poses[number].T_segment_scan.inverse();
    for (uint64_t i = number; i < traverse.poses.size(); ++i) {
      traverse.poses[i].segment = 1;
      traverse.poses[i].T_segment_scan = T_new_old * traverse.poses[i].T_segment_scan;
    }
    traverse.poses[number].origin = PoseOrigin::kSegmentStart;
    traverse.num_segments = 2;
    return traverse;
  }

  static inline std::unique_ptr<DriveScans> drive_;
  static inline std::unique_ptr<Traverse> tracked_;
};

TEST_F(FindLinksTest, TheNearestScansThatHaveNoLinkYet) {
  Traverse traverse = *tracked_;
  std::set<std::pair<uint64_t, uint64_t>> pairs;
  for (const TraverseLink& link : traverse.links) pairs.emplace(link.source, link.target);
  for (int round = 0; round < 2; ++round) {
    const auto links = FindLinks(traverse, 8, drive_->Loader(), {});
    ASSERT_THAT(links, IsOk());
    EXPECT_EQ(links->size(), 3U);
    for (const TraverseLink& link : *links) {
      EXPECT_EQ(link.kind, LinkKind::kNeighbour);
      EXPECT_EQ(link.source, 8U);
      EXPECT_TRUE(pairs.emplace(link.source, link.target).second) << "twice with " << link.target;
      ExpectTrue(link);
    }
    traverse.links.insert(traverse.links.end(), links->begin(), links->end());
  }
}

TEST_F(FindLinksTest, ANewSegmentRecognisesAnOlderOne) {
  const auto links = FindLinks(Broken(6), 6, drive_->Loader(), {});
  ASSERT_THAT(links, IsOk());
  const auto joins = std::count_if(links->begin(), links->end(), [](const TraverseLink& link) {
    return link.target < 6 && link.result.verdict.accepted;
  });
  EXPECT_EQ(joins, 1);  // one is enough
  for (const TraverseLink& link : *links) {
    if (link.result.verdict.accepted) ExpectTrue(link);
  }
}

TEST_F(FindLinksTest, LoopClosuresAlsoBetweenSegments) {
  TrackingOptions options;
  options.min_loop_gap = 5;
  options.max_loop_candidates = 4;
  const auto closures = FindLoopClosures(*tracked_, drive_->Loader(), options);
  ASSERT_THAT(closures, IsOk());
  EXPECT_EQ(closures->size(), 4U);
  for (const TraverseLink& link : *closures) {
    EXPECT_EQ(link.kind, LinkKind::kLoopClosure);
    EXPECT_GE(link.source - link.target, 5U);
    ExpectTrue(link);
  }
  options.min_loop_gap = 100;
  const auto joins = FindLoopClosures(Broken(5), drive_->Loader(), options);
  ASSERT_THAT(joins, IsOk());
  EXPECT_FALSE(joins->empty());
  EXPECT_LE(joins->size(), 4U);
  for (const TraverseLink& link : *joins) {
    EXPECT_LT(link.target, 5U);
    EXPECT_GE(link.source, 5U);
    if (link.result.verdict.accepted) ExpectTrue(link);
  }
  EXPECT_TRUE(
      std::any_of(joins->begin(), joins->end(), [](const TraverseLink& link) { return link.result.verdict.accepted; }));
}

TEST_F(FindLinksTest, AScanFromElsewhereIsNotRecognised) {
  Traverse traverse = *tracked_;
  TrajectoryPose pose;
  pose.sequence_number = 9;
  pose.segment = 1;
  AppendScan(traverse, {pose, {}, -1}, std::nullopt);
  const std::shared_ptr<const PreparedScan> elsewhere = testing::ScanElsewhere();
  const auto load = [&](uint64_t number, const Stop&) -> absl::StatusOr<std::shared_ptr<const PreparedScan>> {
    if (number == 9) return elsewhere;
    return drive_->Get(number);
  };
  TrackingOptions options;
  options.max_loop_candidates = 3;
  const auto links = FindLinks(traverse, 9, load, options);
  ASSERT_THAT(links, IsOk());
  EXPECT_LE(links->size(), 3U);
  for (const TraverseLink& link : *links) EXPECT_FALSE(link.result.verdict.accepted);
}

TEST_F(FindLinksTest, WhatIsNotThereOrNotKept) {
  EXPECT_THAT(FindLinks(*tracked_, 9, drive_->Loader(), {}), HasCode(absl::StatusCode::kInvalidArgument));
  const auto none = [](uint64_t, const Stop&) -> absl::StatusOr<std::shared_ptr<const PreparedScan>> {
    return absl::NotFoundError("not kept");
  };
  for (const auto& links : {FindLinks(Broken(6), 6, none, {}), FindLoopClosures(Broken(6), none, {})}) {
    ASSERT_THAT(links, IsOk());
    EXPECT_TRUE(links->empty());
  }
  const auto broken = [](uint64_t, const Stop&) -> absl::StatusOr<std::shared_ptr<const PreparedScan>> {
    return absl::DataLossError("broken");
  };
  EXPECT_THAT(FindLinks(*tracked_, 8, broken, {}), HasCode(absl::StatusCode::kDataLoss));
  EXPECT_THAT(FindLoopClosures(Traverse{}, broken, {}), IsOk());
}

// The nearest neighbours and the likeliest places are lost: others take their turn.
TEST_F(FindLinksTest, ScansThatAreNotKeptCountForNothing) {
  const auto all = FindLinks(*tracked_, 8, drive_->Loader(), {});
  ASSERT_THAT(all, IsOk());
  std::set<uint64_t> lost;
  std::map<uint64_t, int> times_asked;
  const auto load = [&](uint64_t number, const Stop&) -> absl::StatusOr<std::shared_ptr<const PreparedScan>> {
    ++times_asked[number];
    if (lost.contains(number)) return absl::NotFoundError("not kept");
    return drive_->Get(number);
  };
  for (size_t i = 0; i < 2; ++i) lost.insert((*all)[i].target);
  const auto links = FindLinks(*tracked_, 8, load, {});
  ASSERT_THAT(links, IsOk());
  EXPECT_EQ(links->size(), 3U);
  TrackingOptions options;
  options.min_loop_gap = 3;
  options.max_loop_candidates = 5;
  lost = {0, 3};
  times_asked.clear();
  const auto closures = FindLoopClosures(*tracked_, load, options);
  ASSERT_THAT(closures, IsOk());
  EXPECT_EQ(closures->size(), 5U);
  for (const uint64_t number : lost) EXPECT_LE(times_asked[number], 1) << number;
}

Traverse Segments(int num_segments, int num_scans_each) {
  Traverse traverse;
  for (int i = 0; i < num_segments * num_scans_each; ++i) {
    TrajectoryPose pose;
    pose.sequence_number = static_cast<uint64_t>(i);
    pose.segment = i / num_scans_each;
    AppendScan(traverse, {pose, {}, -1}, std::nullopt);
  }
  return traverse;
}

// Featureless ground: nothing looks like it, so no link is tried and each place is compared in vain.
std::shared_ptr<const PreparedScan> FlatScan() {
  auto scan = std::make_shared<Scan>();
  for (int x = -30; x <= 30; ++x) {
    for (int y = -30; y <= 30; ++y) {
      scan->points.emplace_back(0.3F * static_cast<float>(x), 0.3F * static_cast<float>(y), -1.0F);
    }
  }
  return *PreparedScan::Create(std::move(scan));
}

TEST(RecognitionTest, FirstScansOfASegmentAndSomeLaterOnesOnly) {
  const std::shared_ptr<const PreparedScan> flat = FlatScan();
  int num_loaded = 0;
  const auto load = [&](uint64_t, const Stop&) -> absl::StatusOr<std::shared_ptr<const PreparedScan>> {
    ++num_loaded;
    return flat;
  };
  TrackingOptions options;
  options.num_neighbours = 0;
  options.num_scans_to_recognise = 2;
  options.recognition_interval = 7;
  const Traverse traverse = Segments(2, 20);
  std::vector<uint64_t> searching;
  for (uint64_t number = 0; number < traverse.poses.size(); ++number) {
    num_loaded = 0;
    ASSERT_THAT(FindLinks(traverse, number, load, options), IsOk());
    EXPECT_LE(num_loaded, 1 + options.max_places_compared);
    if (num_loaded > 1) searching.push_back(number);
  }
  EXPECT_THAT(searching, ::testing::ElementsAre(20U, 21U, 22U, 29U, 36U));
}

TEST(RecognitionTest, ManySegmentsShareABudgetOfPlaces) {
  const std::shared_ptr<const PreparedScan> flat = FlatScan();
  std::map<uint64_t, int> times_loaded;
  int num_loaded = 0;
  const auto load = [&](uint64_t number, const Stop&) -> absl::StatusOr<std::shared_ptr<const PreparedScan>> {
    ++times_loaded[number];
    ++num_loaded;
    return flat;
  };
  TrackingOptions options;
  options.loop_distance_m = -1.0;  // none by position
  options.max_places_in_all = 96;  // 12 searches of 8
  const auto links = FindLoopClosures(Segments(50, 6), load, options);
  ASSERT_THAT(links, IsOk());
  EXPECT_TRUE(links->empty());
  EXPECT_LE(num_loaded, 12 + 96);
  EXPECT_GE(num_loaded, 80);
  // A few segments have all they want.
  num_loaded = 0;
  options.max_places_in_all = TrackingOptions().max_places_in_all;
  ASSERT_THAT(FindLoopClosures(Segments(3, 30), load, options), IsOk());
  EXPECT_EQ(num_loaded, 8 + 4 * 30 + 4 * options.max_places_compared);
  options.max_places_in_all = 0;
  num_loaded = 0;
  ASSERT_THAT(FindLoopClosures(Segments(3, 30), load, options), IsOk());
  EXPECT_EQ(num_loaded, 0);
}

TEST_F(FindLinksTest, EndsWhenAsked) {
  std::stop_source source;
  source.request_stop();
  const Stop stop{source.get_token(), std::nullopt};
  EXPECT_THAT(FindLinks(*tracked_, 8, drive_->Loader(), {}, stop), HasCode(absl::StatusCode::kCancelled));
  EXPECT_THAT(FindLoopClosures(Broken(6), drive_->Loader(), {}, stop), HasCode(absl::StatusCode::kCancelled));
}

}  // namespace
}  // namespace curvereg
