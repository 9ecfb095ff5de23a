// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "render/scan_pictures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/testing/matchers.h"
#include "tests/testing/scenes.h"

namespace curvereg {
namespace {

using ::testing::ElementsAre;
using testing::HasCode;
using testing::IsOk;

Scan Ground() { return testing::BumpyGround(testing::RoverPose(0.0, 0.0, 0.4), {.num_columns = 360}); }

std::vector<std::string> Names(const ScanPictures& pictures) {
  std::vector<std::string> names;
  for (const NamedPicture& named : pictures.pictures) names.push_back(named.name);
  return names;
}

TEST(DrawScanTest, DrawsEveryKindOnceInOrderOfTheStages) {
  const auto all = DrawScan(Ground());
  ASSERT_THAT(all, IsOk());
  EXPECT_THAT(Names(*all), ElementsAre("range", "bearing_angle", "coefficients", "range_doc_2", "range_doc_3",
                                       "range_doc_4", "range_doc_5", "range_keypoints", "elevation", "elevation_doc_2",
                                       "elevation_doc_3", "elevation_doc_4", "elevation_doc_5", "elevation_doc_6",
                                       "elevation_keypoints", "occupancy", "occupancy_doc_2", "occupancy_doc_3",
                                       "occupancy_doc_4", "occupancy_doc_5", "occupancy_doc_6", "occupancy_keypoints"));
  EXPECT_GT(all->num_points, 1000);
  ASSERT_EQ(all->num_keypoints.size(), 3U);
  EXPECT_EQ(all->num_keypoints[1].first, "elevation");
  EXPECT_GT(all->num_keypoints[1].second, 10);
}

TEST(DrawScanTest, APictureIsTheSameAloneAsAmongAll) {
  const auto all = DrawScan(Ground());
  ASSERT_THAT(all, IsOk());
  size_t num_pictures = 0;
  for (const PictureKind kind :
       {PictureKind::kViews, PictureKind::kCoefficients, PictureKind::kDifferences, PictureKind::kKeypoints}) {
    const auto some = DrawScan(Ground(), {kind});
    ASSERT_THAT(some, IsOk());
    for (const NamedPicture& named : some->pictures) {
      EXPECT_EQ(named.kind, kind);
      const auto same = std::find_if(all->pictures.begin(), all->pictures.end(),
                                     [&](const NamedPicture& other) { return other.name == named.name; });
      ASSERT_NE(same, all->pictures.end()) << named.name;
      EXPECT_EQ(same->picture.pixels, named.picture.pixels) << named.name;
    }
    num_pictures += some->pictures.size();
  }
  EXPECT_EQ(num_pictures, all->pictures.size());
}

// Whether all pixels of rows [top, bottom) and columns [left, right) are white.
bool IsWhite(const Image<Rgb>& picture, int top, int bottom, int left, int right) {
  for (int row = top; row < bottom; ++row) {
    for (int col = left; col < right; ++col) {
      if (picture(row, col) != Rgb{255, 255, 255}) return false;
    }
  }
  return true;
}

TEST(DrawScanTest, EachPictureHasATitleAndScalesAndNothingIsCutOff) {
  const auto all = DrawScan(Ground());
  ASSERT_THAT(all, IsOk());
  for (const NamedPicture& named : all->pictures) {
    const Image<Rgb>& picture = named.picture;
    const int rows = picture.rows, cols = picture.cols;
    EXPECT_FALSE(IsWhite(picture, 0, 40, 0, cols)) << named.name;                // title
    EXPECT_FALSE(IsWhite(picture, rows - 40, rows, 0, cols / 2)) << named.name;  // scale bar
    EXPECT_FALSE(IsWhite(picture, 0, rows, 0, 40)) << named.name;                // y axis
    EXPECT_FALSE(IsWhite(picture, 0, rows, cols - 60, cols)) << named.name;      // colour bar
    EXPECT_TRUE(IsWhite(picture, 0, 4, 0, cols)) << named.name;
    EXPECT_TRUE(IsWhite(picture, rows - 4, rows, 0, cols)) << named.name;
    EXPECT_TRUE(IsWhite(picture, 0, rows, 0, 4)) << named.name;
    EXPECT_TRUE(IsWhite(picture, 0, rows, cols - 4, cols)) << named.name;
  }
}

TEST(DrawScanTest, StopsWhenAsked) {
  std::stop_source source;
  source.request_stop();
  EXPECT_THAT(DrawScan(Ground(), {}, Stop{source.get_token(), {}}), HasCode(absl::StatusCode::kCancelled));
  EXPECT_THAT(DrawScan(Ground(), {}, Stop{{}, std::chrono::steady_clock::now()}),
              HasCode(absl::StatusCode::kDeadlineExceeded));
}

TEST(DrawScanTest, AScanAtTheSensorIsAnError) {
  Scan scan;
  scan.points.assign(200, Eigen::Vector3f::Zero());
  EXPECT_THAT(DrawScan(scan), HasCode(absl::StatusCode::kInvalidArgument));
}

}  // namespace
}  // namespace curvereg
