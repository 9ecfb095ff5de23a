// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/views/range_image.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace curvereg {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180.0;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Eigen::Vector3f Polar(double azimuth, double elevation, double range) {
  return (range * Eigen::Vector3d(std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation),
                                  std::sin(elevation)))
      .cast<float>();
}

// One return per pixel of half a degree between two elevations [deg], at the range where the beam meets z = -height.
std::vector<Eigen::Vector3f> LevelGround(double height) {
  std::vector<Eigen::Vector3f> points;
  for (int row = 0; row < 60; ++row) {
    const double elevation = -(10.25 + 0.5 * row) * kDegree;
    for (int col = 0; col < 720; ++col) {
      points.push_back(Polar((0.5 * col + 0.25) * kDegree, elevation, -height / std::sin(elevation)));
    }
  }
  return points;
}

TEST(RangeImageTest, PutsReturnsWhereTheyWereSeen) {
  const std::vector<Eigen::Vector3f> points = {Polar(0.1 * kDegree, 10.1 * kDegree, 5.0),
                                               Polar(90.1 * kDegree, -9.9 * kDegree, 7.0)};
  const RangeImage image = *ComputeRangeImage(points);
  EXPECT_EQ(image.range.cols, 720);
  EXPECT_EQ(image.range.rows, 41);  // from the half degree that holds 10.1 to the one that holds -9.9
  EXPECT_NEAR(image.range(0, 359), 5.0, 1e-5);
  EXPECT_NEAR(image.range(40, 179), 7.0, 1e-5);
  EXPECT_EQ(image.point(0, 359), 0);
  EXPECT_EQ(image.point(40, 179), 1);
  EXPECT_EQ(image.point(20, 300), -1);
  int num_valid = 0;
  for (const uint8_t valid : image.valid.pixels) num_valid += valid;
  EXPECT_EQ(num_valid, 2);
  EXPECT_NEAR(image.ElevationOf(0.0), 10.25 * kDegree, 1e-12);
  EXPECT_NEAR(image.AzimuthOf(359.0), 0.25 * kDegree, 1e-12);
}

TEST(RangeImageTest, EveryPixelOfARegularScanHoldsItsOwnReturn) {
  const std::vector<Eigen::Vector3f> points = LevelGround(1.8);
  const RangeImage image = *ComputeRangeImage(points);
  ASSERT_EQ(image.range.rows, 60);
  for (int row = 0; row < image.range.rows; ++row) {
    for (int col = 0; col < image.range.cols; ++col) {
      ASSERT_EQ(image.valid(row, col), 1) << row << " " << col;
      const auto& point = points[static_cast<size_t>(image.point(row, col))];
      ASSERT_LT((point - Polar(image.AzimuthOf(col), image.ElevationOf(row), image.range(row, col))).norm(), 1e-4F);
    }
  }
}

TEST(RangeImageTest, KeepsTheNearestReturnOfAPixel) {
  const std::vector<Eigen::Vector3f> points = {Polar(0.1 * kDegree, 0.1 * kDegree, 9.0),
                                               Polar(0.2 * kDegree, 0.2 * kDegree, 4.0),
                                               Polar(0.3 * kDegree, 0.3 * kDegree, 6.0)};
  const RangeImage image = *ComputeRangeImage(points);
  ASSERT_EQ(image.range.rows, 1);
  EXPECT_EQ(image.point(0, 359), 1);
  EXPECT_NEAR(image.range(0, 359), 4.0, 1e-5);
}

TEST(RangeImageTest, BothSidesOfTheSeamAndThePolesFallInside) {
  const float tiny = -1e-30F;
  const std::vector<Eigen::Vector3f> points = {{-3.0F, 0.0F, 0.0F}, {-3.0F, tiny, 0.0F},    {0.0F, 0.0F, 2.0F},
                                               {0.0F, 0.0F, -2.0F}, {-3.0F, -0.001F, 0.5F}, {-3.0F, 0.001F, 0.5F}};
  const RangeImage image = *ComputeRangeImage(points);
  EXPECT_EQ(image.range.rows, 360);
  EXPECT_EQ(image.valid(0, 359) + image.valid(0, 360), 1);
  EXPECT_EQ(image.valid(359, 359) + image.valid(359, 360), 1);
  const int row = static_cast<int>((90.0 - std::atan2(0.5, 3.0) / kDegree) * 2.0);
  EXPECT_EQ(image.point(row, 0), 5);
  EXPECT_EQ(image.point(row, 719), 4);
}

TEST(RangeImageTest, SpanFollowsTheOptions) {
  const std::vector<Eigen::Vector3f> points = LevelGround(1.8);
  RangeImageOptions options;
  options.min_rows = 96;
  RangeImage image = *ComputeRangeImage(points, options);
  EXPECT_EQ(image.range.rows, 96);
  EXPECT_EQ(image.valid(0, 0), 0);
  EXPECT_EQ(image.valid(18, 0), 1);
  EXPECT_EQ(image.valid(77, 0), 1);
  EXPECT_EQ(image.valid(78, 0), 0);
  EXPECT_NEAR(image.ElevationOf(18.0), -10.25 * kDegree, 1e-12);
  options.full_sphere = true;
  image = *ComputeRangeImage(points, options);
  EXPECT_EQ(image.range.rows, 360);
  EXPECT_EQ(image.first_row, 0);
  options = {};
  options.step_rad = 1.0 * kDegree;
  image = *ComputeRangeImage(points, options);
  EXPECT_EQ(image.range.cols, 360);
  EXPECT_EQ(image.range.rows, 30);
}

TEST(RangeImageTest, NothingSeenGivesAnEmptyImageAndBadStepsAreRefused) {
  const std::vector<Eigen::Vector3f> nothing = {Eigen::Vector3f::Constant(kNan), Eigen::Vector3f::Zero()};
  EXPECT_TRUE(ComputeRangeImage(nothing)->range.empty());
  EXPECT_TRUE(ComputeRangeImage({})->range.empty());
  EXPECT_TRUE(ComputeBearingAngles(*ComputeRangeImage({}), {}).angle.empty());
  for (const double step : {0.0, -0.1, 1.0, std::numeric_limits<double>::quiet_NaN()}) {
    RangeImageOptions options;
    options.step_rad = step;
    EXPECT_EQ(ComputeRangeImage(LevelGround(1.8), options).status().code(), absl::StatusCode::kInvalidArgument) << step;
  }
}

TEST(BearingAngleTest, OfLevelGroundIsTheDepressionOfTheBeam) {
  const std::vector<Eigen::Vector3f> points = LevelGround(1.8);
  const RangeImage image = *ComputeRangeImage(points);
  const BearingAngleImage bearing = ComputeBearingAngles(image, points);
  for (int row = 0; row + 1 < image.range.rows; ++row) {
    for (int col = 0; col < image.range.cols; ++col) {
      ASSERT_EQ(bearing.valid(row, col), 1);
      ASSERT_NEAR(bearing.angle(row, col), -image.ElevationOf(row), 2e-4) << row << " " << col;
    }
  }
  EXPECT_EQ(bearing.valid(image.range.rows - 1, 0), 0) << "there is nothing below the last row";
}

TEST(BearingAngleTest, AlongRowsOfARoundWallIsARightAngleAllAround) {
  std::vector<Eigen::Vector3f> points;
  for (int col = 0; col < 720; ++col) points.push_back(Polar((0.5 * col + 0.25) * kDegree, 0.1 * kDegree, 10.0));
  const RangeImage image = *ComputeRangeImage(points);
  const BearingAngleImage bearing =
      ComputeBearingAngles(image, points, {.direction = BearingDirection::kAlongRow, .max_gap_px = 1});
  for (int col = 0; col < 720; ++col) {
    ASSERT_EQ(bearing.valid(0, col), 1) << col;
    ASSERT_NEAR(bearing.angle(0, col), kPi / 2.0 - 0.25 * kDegree, 1e-3) << col;  // a chord, not the tangent
  }
}

TEST(BearingAngleTest, ReachesOverGapsAsFarAsAsked) {
  const std::vector<Eigen::Vector3f> points = {Polar(0.25 * kDegree, 0.25 * kDegree, 10.0),
                                               Polar(0.25 * kDegree, -1.25 * kDegree, 10.0)};
  const RangeImage image = *ComputeRangeImage(points);
  ASSERT_EQ(image.range.rows, 4);
  EXPECT_EQ(ComputeBearingAngles(image, points, {.max_gap_px = 2}).valid(0, 359), 0);
  EXPECT_EQ(ComputeBearingAngles(image, points, {.max_gap_px = 3}).valid(0, 359), 1);
}

}  // namespace
}  // namespace curvereg
