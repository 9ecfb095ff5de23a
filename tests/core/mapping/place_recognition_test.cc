// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/place_recognition.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "tests/testing/matchers.h"
#include "tests/testing/traverses.h"

namespace curvereg {
namespace {

using testing::DriveScans;
using testing::HasCode;
using testing::IsOk;

TEST(RankPlacesTest, NearPlacesLookMoreAlikeThanFarOnes) {
  DriveScans drive(*sim::Simulation::Create(testing::SmallDrive(9)));
  const auto place = PlaceFeatures(*drive.Get(3));
  ASSERT_THAT(place, IsOk());
  EXPECT_EQ(place->image.values.size(), 0U);
  const std::vector<uint64_t> numbers = {0, 1, 2, 4, 5, 6, 7, 8, 99};
  const auto ranked = RankPlaces(*place, numbers, drive.Loader());
  ASSERT_THAT(ranked, IsOk());
  ASSERT_EQ(ranked->size(), 8U);  // 99 is not kept
  EXPECT_THAT((*ranked)[0].sequence_number, ::testing::AnyOf(2U, 4U));
  for (size_t i = 1; i < ranked->size(); ++i) EXPECT_LE((*ranked)[i].likeness, (*ranked)[i - 1].likeness);
  EXPECT_LT(PlaceLikeness(*place, **testing::StrangerScan()->View(BirdsEyeView::kElevation, 0)), (*ranked)[0].likeness);
}

TEST(RankPlacesTest, ErrorsAreHandedOn) {
  const auto broken = [](uint64_t, const Stop&) -> absl::StatusOr<std::shared_ptr<const PreparedScan>> {
    return absl::DataLossError("broken");
  };
  const std::vector<uint64_t> one = {1};
  EXPECT_THAT(RankPlaces(ViewFeatures{}, one, broken), HasCode(absl::StatusCode::kDataLoss));
  EXPECT_THAT(RankPlaces(ViewFeatures{}, one, broken, {{}, std::chrono::steady_clock::now()}),
              HasCode(absl::StatusCode::kDeadlineExceeded));
  EXPECT_TRUE(RankPlaces(ViewFeatures{}, {}, broken)->empty());
}

TEST(PlaceLikenessTest, NothingIsLikeNothing) { EXPECT_EQ(PlaceLikeness(ViewFeatures{}, ViewFeatures{}), 0); }

Traverse Segments(const std::vector<int>& segments) {
  Traverse traverse;
  for (const int segment : segments) {
    TrajectoryPose pose;
    pose.sequence_number = traverse.poses.size();
    pose.segment = segment;
    traverse.poses.push_back(pose);
  }
  return traverse;
}

TEST(PlacesOfOlderSegmentsTest, LastScansFirstAndOlderOnly) {
  const Traverse traverse = Segments({0, 0, 0, 1, 1, 2, 1});
  EXPECT_THAT(PlacesOfOlderSegments(traverse, 5, 10), ::testing::UnorderedElementsAre(0U, 1U, 2U, 3U, 4U, 6U));
  EXPECT_THAT(PlacesOfOlderSegments(traverse, 5, 2), ::testing::UnorderedElementsAre(2U, 6U));
  EXPECT_THAT(PlacesOfOlderSegments(traverse, 3, 10), ::testing::UnorderedElementsAre(0U, 1U, 2U));
  EXPECT_TRUE(PlacesOfOlderSegments(traverse, 1, 10).empty());
  EXPECT_TRUE(PlacesOfOlderSegments(traverse, 5, 0).empty());
}

TEST(PlacesOfOlderSegmentsTest, AnotherScanSeesOthers) {
  std::vector<int> segments(100, 0);
  segments.insert(segments.end(), 30, 1);
  const Traverse traverse = Segments(segments);
  std::set<uint64_t> seen;
  for (uint64_t number = 100; number < 130; ++number) {
    const std::vector<uint64_t> places = PlacesOfOlderSegments(traverse, number, 5);
    EXPECT_GE(places.size(), 4U);  // the last one may come up twice
    EXPECT_LE(places.size(), 5U);
    EXPECT_TRUE(std::find(places.begin(), places.end(), 99U) != places.end());
    seen.insert(places.begin(), places.end());
  }
  EXPECT_EQ(seen.size(), 100U);
}

}  // namespace
}  // namespace curvereg
