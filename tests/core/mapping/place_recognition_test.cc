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
  const auto ranked = RankPlaces(*place, {numbers, 100}, drive.Loader());
  ASSERT_THAT(ranked, IsOk());
  ASSERT_EQ(ranked->size(), 8U);  // 99 is not kept
  EXPECT_THAT((*ranked)[0].sequence_number, ::testing::AnyOf(2U, 4U));
  for (size_t i = 1; i < ranked->size(); ++i) EXPECT_LE((*ranked)[i].likeness, (*ranked)[i - 1].likeness);
  const std::vector<uint64_t> lost_first = {98, 99, 0, 4, 8};
  const auto few = RankPlaces(*place, {lost_first, 2}, drive.Loader());
  ASSERT_THAT(few, IsOk());
  ASSERT_EQ(few->size(), 2U);  // those that are not kept do not count
  EXPECT_EQ((*few)[0].sequence_number, 4U);
  EXPECT_EQ((*few)[1].sequence_number, 0U);
  EXPECT_LT(PlaceLikeness(*place, **testing::ScanElsewhere()->View(BirdsEyeView::kElevation, 0)),
            (*ranked)[0].likeness);
}

TEST(RankPlacesTest, ErrorsAreHandedOn) {
  const auto broken = [](uint64_t, const Stop&) -> absl::StatusOr<std::shared_ptr<const PreparedScan>> {
    return absl::DataLossError("broken");
  };
  const std::vector<uint64_t> one = {1};
  EXPECT_THAT(RankPlaces(ViewFeatures{}, {one, 1}, broken), HasCode(absl::StatusCode::kDataLoss));
  EXPECT_THAT(RankPlaces(ViewFeatures{}, {one, 1}, broken, {{}, std::chrono::steady_clock::now()}),
              HasCode(absl::StatusCode::kDeadlineExceeded));
  EXPECT_TRUE(RankPlaces(ViewFeatures{}, {{}, 1}, broken)->empty());
  EXPECT_TRUE(RankPlaces(ViewFeatures{}, {one, 0}, broken)->empty());
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
  const std::vector<uint64_t> places = PlacesOfOlderSegments(traverse, 5, 10);
  EXPECT_THAT(places, ::testing::UnorderedElementsAre(0U, 1U, 2U, 3U, 4U, 6U));
  EXPECT_EQ(places[0], 6U);
  EXPECT_EQ(places[1], 2U);
  EXPECT_EQ(PlacesOfOlderSegments(traverse, 5, 2)[0], 6U);
  EXPECT_THAT(PlacesOfOlderSegments(traverse, 3, 10), ::testing::UnorderedElementsAre(0U, 1U, 2U));
  EXPECT_TRUE(PlacesOfOlderSegments(traverse, 1, 10).empty());
}

// A hundred segments of one scan each must not hide the long one before them.
TEST(PlacesOfOlderSegmentsTest, HalfIsLeftForOthersThanLastScans) {
  std::vector<int> segments(100, 0);
  for (int i = 1; i <= 100; ++i) segments.push_back(i);
  const std::vector<uint64_t> places = PlacesOfOlderSegments(Segments(segments), 199, 20);
  EXPECT_GE(std::count_if(places.begin(), places.begin() + 20, [](uint64_t number) { return number < 100; }), 5);
  EXPECT_EQ(places.size(), 199U);
  EXPECT_EQ(std::set<uint64_t>(places.begin(), places.end()).size(), 199U);
}

TEST(PlacesOfOlderSegmentsTest, AnotherScanSeesOthers) {
  std::vector<int> segments(100, 0);
  segments.insert(segments.end(), 30, 1);
  const Traverse traverse = Segments(segments);
  std::set<uint64_t> seen;
  for (uint64_t number = 100; number < 130; ++number) {
    std::vector<uint64_t> places = PlacesOfOlderSegments(traverse, number, 5);
    EXPECT_EQ(places.size(), 100U);
    EXPECT_EQ(places[0], 99U);
    places.resize(5);
    seen.insert(places.begin(), places.end());
  }
  EXPECT_EQ(seen.size(), 100U);
}

}  // namespace
}  // namespace curvereg
