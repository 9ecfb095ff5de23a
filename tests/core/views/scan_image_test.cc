// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/views/scan_image.h"

#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <numbers>
#include <numeric>

#include "core/base/rigid_transform.h"
#include "tests/testing/same_bytes.h"
#include "tests/testing/scenes.h"

namespace curvereg {
namespace {

using Points = std::vector<Eigen::Vector3f>;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr BirdsEyeOptions kSmall{.cell_m = 0.5, .size = 16};
const Eigen::Matrix3d kUpright = Eigen::Matrix3d::Identity();

int NumValid(const BirdsEyeImage& image) {
  return std::accumulate(image.valid.pixels.begin(), image.valid.pixels.end(), 0);
}

TEST(ScanImageTest, ElevationIsTheMeanHeightOfEachCell) {
  const Points points = {{0.1F, 0.2F, -1.0F}, {0.4F, 0.3F, -2.0F}, {-0.1F, 1.1F, 3.0F}};
  const BirdsEyeImage image = ElevationImage(points, kUpright, kSmall);
  ASSERT_EQ(image.values.rows, 16);
  ASSERT_EQ(image.values.cols, 16);
  EXPECT_EQ(NumValid(image), 2);
  // Columns grow with x, rows with y; the sensor is where cells 7 and 8 meet.
  EXPECT_FLOAT_EQ(image.values(8, 8), -1.5F);
  EXPECT_FLOAT_EQ(image.values(10, 7), 3.0F);
  EXPECT_EQ(image.valid(8, 8), 1);
  EXPECT_EQ(image.valid(10, 7), 1);
  EXPECT_EQ(image.values(0, 0), 0.0F);
}

TEST(ScanImageTest, MedianHeightsIgnoreAFalseReturn) {
  Points points;
  for (const float height : {-1.02F, -1.0F, 7.0F, -0.98F, -1.01F}) points.emplace_back(0.1F, 0.2F, height);
  points.emplace_back(-0.1F, 1.1F, 3.0F);
  BirdsEyeOptions options = kSmall;
  options.median = true;
  const BirdsEyeImage image = ElevationImage(points, kUpright, options);
  EXPECT_FLOAT_EQ(image.values(8, 8), -1.0F);
  EXPECT_FLOAT_EQ(image.values(10, 7), 3.0F);
  EXPECT_EQ(NumValid(image), 2);
  EXPECT_EQ(NumValid(ElevationImage({}, kUpright, options)), 0);
}

TEST(ScanImageTest, ElevationOfATiltedPlane) {
  const Eigen::Vector3d normal = Eigen::Vector3d(-0.1, -0.2, 1.0).normalized();
  const auto points = testing::PatchPoints({.centre = {0.0, 0.0, -1.5}, .normal = normal, .side_m = 12.0}, 50000, 4);
  const BirdsEyeImage image = ElevationImage(points, kUpright, kSmall);
  EXPECT_EQ(NumValid(image), 256);
  for (int row = 0; row < 16; ++row) {
    for (int col = 0; col < 16; ++col) {
      const Eigen::Vector2d position = image.PositionOf(row, col);
      EXPECT_NEAR(image.values(row, col), -1.5 + 0.1 * position.x() + 0.2 * position.y(), 0.03);
    }
  }
}

TEST(ScanImageTest, LevellingRotationIsApplied) {
  // A sensor that stands on its side: its x axis looks up.
  Eigen::Matrix3d R_level_sensor;
  R_level_sensor << 0, 1, 0, 0, 0, 1, 1, 0, 0;
  const BirdsEyeImage image = ElevationImage({{2.5F, 1.2F, -0.7F}}, R_level_sensor, kSmall);
  EXPECT_FLOAT_EQ(image.values(6, 10), 2.5F);
  EXPECT_EQ(NumValid(image), 1);
}

TEST(ScanImageTest, PixelOfInvertsPositionOf) {
  const BirdsEyeImage image = ElevationImage({}, kUpright, {.cell_m = 0.3, .size = 21});
  for (const auto& [row, col] : {std::pair{0.0, 0.0}, {10.0, 10.0}, {3.25, 17.5}}) {
    const Eigen::Vector2d pixel = image.PixelOf(image.PositionOf(row, col));
    EXPECT_NEAR(pixel.x(), row, 1e-12);
    EXPECT_NEAR(pixel.y(), col, 1e-12);
  }
  EXPECT_LT(image.PositionOf(10.0, 10.0).norm(), 1e-12);  // the centre of an odd image
  EXPECT_NEAR(image.PositionOf(10.0, 12.0).x(), 0.6, 1e-12);
  EXPECT_NEAR(image.PositionOf(12.0, 10.0).y(), 0.6, 1e-12);
}

TEST(ScanImageTest, ReturnsOutsideOrNotFiniteAreSkipped) {
  const Points points = {{4.1F, 0.0F, 0.0F},   {0.0F, -4.1F, 0.0F}, {1e30F, 0.0F, 0.0F},     {kNan, 0.0F, 0.0F},
                         {0.0F, kInfinity, 0}, {0.0F, 0.0F, kNan},  {0.0F, 0.0F, -kInfinity}};
  EXPECT_EQ(NumValid(ElevationImage(points, kUpright, kSmall)), 0);
  EXPECT_EQ(NumValid(OccupancyImage(ComputeOccupancySlices(points, kUpright, kSmall))), 0);
}

TEST(ScanImageTest, EmptyScanGivesAnEmptyView) {
  const BirdsEyeImage elevation = ElevationImage({}, kUpright);
  EXPECT_EQ(elevation.values.size(), 256U * 256U);
  EXPECT_EQ(NumValid(elevation), 0);
  EXPECT_EQ(NumValid(OccupancyImage(ComputeOccupancySlices({}, kUpright, kSmall))), 0);
}

TEST(ScanImageTest, EachSliceOfHalfAMetreIsOneBit) {
  const Points points = {{0.1F, 0.1F, 0.2F}, {0.1F, 0.1F, 0.3F}, {0.1F, 0.1F, -0.2F}, {0.1F, 0.1F, 2.6F}};
  const OccupancySlices slices = ComputeOccupancySlices(points, kUpright, kSmall);
  // Heights 0.2 and 0.3 share [0, 0.5) = bit 32; -0.2 is bit 31; 2.6 is bit 37.
  const uint64_t expected = (uint64_t{1} << 32) | (uint64_t{1} << 31) | (uint64_t{1} << 37);
  EXPECT_EQ(slices.slices(8, 8), expected);
  const BirdsEyeImage image = OccupancyImage(slices);
  EXPECT_EQ(image.values(8, 8), 3.0F);
  EXPECT_EQ(NumValid(image), 1);
  EXPECT_DOUBLE_EQ(image.cell_m, 0.5);
}

TEST(ScanImageTest, HeightsBeyondTheSlicesAreDropped) {
  const Points points = {{0.1F, 0.1F, 15.9F}, {0.1F, 0.1F, 16.0F}, {0.1F, 0.1F, -16.0F}, {0.1F, 0.1F, -16.1F}};
  const OccupancySlices slices = ComputeOccupancySlices(points, kUpright, kSmall);
  EXPECT_EQ(slices.slices(8, 8), (uint64_t{1} << 63) | uint64_t{1});
}

TEST(ScanImageTest, AQuarterTurnOfTheScanIsAQuarterTurnOfTheImage) {
  const Scan scan = testing::FurnishedHall(testing::UprightPose(0.5, 0.2, 0.3), {.num_columns = 360});
  Points turned;
  for (const Eigen::Vector3f& p : scan.points) turned.emplace_back(-p.y(), p.x(), p.z());
  const OccupancySlices slices = ComputeOccupancySlices(scan.points, kUpright, kSmall);
  const OccupancySlices slices_turned = ComputeOccupancySlices(turned, kUpright, kSmall);
  int num_equal = 0;
  for (int row = 0; row < 16; ++row) {
    // x' = -y, y' = x: column 15 - row, row col.
    for (int col = 0; col < 16; ++col) {
      num_equal += static_cast<int>(slices_turned.slices(col, 15 - row) == slices.slices(row, col));
    }
  }
  EXPECT_GE(num_equal, 254);  // points on the border between cells may change sides
}

TEST(ScanImageTest, SameBytesAtAnyThreadCount) {
  // More than two blocks of points.
  const auto points = testing::PatchPoints({.centre = {1.0, 2.0, -1.5}, .side_m = 40.0, .noise_m = 0.1}, 300000, 5);
  testing::ExpectSameBytesAtAnyThreadCount([&](testing::ByteLog& log) {
    log.Add(ElevationImage(points, kUpright).values.pixels);
    log.Add(ComputeOccupancySlices(points, kUpright, {}).slices.pixels);
  });
}

}  // namespace
}  // namespace curvereg
