// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/scan/voxel_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/testing/same_bytes.h"
#include "tests/testing/scenes.h"

namespace curvereg {
namespace {

using testing::PatchPoints;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(VoxelMapTest, SurfelOfANoisyPlaneHasItsNormalAndVariance) {
  const Eigen::Vector3d normal = Eigen::Vector3d(0.2, -0.3, 1.0).normalized();
  // Well inside the cell of 4 m about (2, 2, -2).
  const auto points =
      PatchPoints({.centre = {2.1, 1.9, -2.2}, .normal = normal, .side_m = 2.4, .noise_m = 0.05}, 4000, 7);
  const auto maps = BuildVoxelMaps(points, {.finest_cell_m = 4.0, .num_levels = 1});
  ASSERT_EQ(maps.size(), 1U);
  ASSERT_EQ(maps[0].surfels().size(), 1U);
  const Surfel& surfel = maps[0].surfels().front();
  EXPECT_EQ(surfel.count, 4000);
  EXPECT_TRUE(surfel.has_normal);
  // Standard errors: direction 0.05 / (0.69 sqrt(4000)) = 1.1 mrad, variance 2.2 %, mean 1 cm along the plane.
  EXPECT_GT(std::abs(surfel.normal.cast<double>().dot(normal)), std::cos(0.005));
  EXPECT_NEAR(surfel.normal.norm(), 1.0, 1e-6);
  EXPECT_NEAR(surfel.normal_variance, 0.0025, 0.0025 * 0.08);
  EXPECT_NEAR(surfel.middle_variance, 2.4 * 2.4 / 12.0, 0.05);
  EXPECT_LT((surfel.mean.cast<double>() - Eigen::Vector3d(2.1, 1.9, -2.2)).norm(), 0.05);
}

TEST(VoxelMapTest, NormalsPointToTheSensorsSide) {
  testing::ScannerOptions scanner;
  scanner.num_columns = 360;
  const Scan scan = testing::FurnishedHall(testing::UprightPose(0.5, 0.2, 0.3), scanner);
  int num_normals = 0;
  for (const VoxelMap& map : BuildVoxelMaps(scan.points)) {
    for (const Surfel& surfel : map.surfels()) {
      EXPECT_LE(surfel.normal.dot(surfel.mean), 1e-5F);
      ++num_normals;
    }
  }
  EXPECT_GT(num_normals, 100);
}

// Mean and covariance of the points in the cell of `map` that holds `surfel`.
void ExpectMomentsOfItsPoints(const VoxelMap& map, const Surfel& surfel, const std::vector<Eigen::Vector3f>& points) {
  const int own = map.Find(surfel.first_point);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  int count = 0;
  for (const Eigen::Vector3f& point : points) {
    if (map.Find(point) != own) continue;
    const Eigen::Vector3d relative = point.cast<double>() - surfel.mean.cast<double>();
    sum += relative;
    squares += relative * relative.transpose();
    ++count;
  }
  ASSERT_EQ(surfel.count, count);
  EXPECT_LT((sum / count).norm(), 1e-5);
  EXPECT_LT((squares / count - surfel.covariance.cast<double>()).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(VoxelMapTest, EveryLevelHoldsTheMomentsOfItsPoints) {
  testing::ScannerOptions scanner;
  scanner.num_columns = 90;
  const Scan scan = testing::BumpyGround(testing::RoverPose(1.0, 2.0, 0.4), scanner);
  const auto maps = BuildVoxelMaps(scan.points);
  ASSERT_EQ(maps.size(), 3U);
  for (size_t level = 0; level < maps.size(); ++level) {
    EXPECT_DOUBLE_EQ(maps[level].cell_m(), 0.5 * std::pow(2.0, level));
    ASSERT_GT(maps[level].surfels().size(), 20U);
    for (const Surfel& surfel : maps[level].surfels()) {
      EXPECT_GE(surfel.count, VoxelOptions{}.min_points);
      ExpectMomentsOfItsPoints(maps[level], surfel, scan.points);
    }
  }
}

TEST(VoxelMapTest, FindsTheElementWhoseCellHoldsThePoint) {
  std::vector<Eigen::Vector3f> points = PatchPoints({.centre = {0.25, 0.25, 0.25}, .side_m = 0.4}, 50, 1);
  const auto far = PatchPoints({.centre = {-0.25, 0.25, 0.25}, .side_m = 0.4}, 50, 2);
  points.insert(points.end(), far.begin(), far.end());
  const VoxelMap map = BuildVoxelMaps(points).front();
  ASSERT_EQ(map.surfels().size(), 2U);
  const int right = map.Find({0.01F, 0.49F, 0.3F});
  const int left = map.Find({-0.01F, 0.01F, 0.3F});
  ASSERT_GE(right, 0);
  ASSERT_GE(left, 0);
  EXPECT_GT(map.surfels()[static_cast<size_t>(right)].mean.x(), 0.0F);
  EXPECT_LT(map.surfels()[static_cast<size_t>(left)].mean.x(), 0.0F);
  EXPECT_EQ(map.Find({0.51F, 0.25F, 0.25F}), -1);
  EXPECT_EQ(map.Find({0.25F, -0.01F, 0.25F}), -1);
  EXPECT_EQ(map.Find({0.25F, 0.25F, 7.0F}), -1);
}

TEST(VoxelMapTest, CellsFarFromTheOriginKeepTheirPrecision) {
  const Eigen::Vector3d normal(0.0, 0.0, 1.0);
  const auto points = PatchPoints({.centre = {8000.3, -8000.3, 100.2}, .side_m = 0.3, .noise_m = 0.01}, 2000, 3);
  const auto maps = BuildVoxelMaps(points, {.num_levels = 1});
  ASSERT_EQ(maps[0].surfels().size(), 1U);
  EXPECT_NEAR(maps[0].surfels()[0].normal_variance, 1e-4, 1e-5);
  EXPECT_GT(std::abs(maps[0].surfels()[0].normal.z()), 0.999F);
}

TEST(VoxelMapTest, PointsOnALineCarryNoNormal) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 40; ++i) points.emplace_back(0.01F * static_cast<float>(i) + 0.05F, 0.2F, 0.3F);
  const auto maps = BuildVoxelMaps(points);
  ASSERT_EQ(maps[0].surfels().size(), 1U);
  EXPECT_FALSE(maps[0].surfels()[0].has_normal);
  EXPECT_NEAR(maps[0].surfels()[0].middle_variance, 0.0, 1e-6);
}

TEST(VoxelMapTest, EqualPointsAreOneElementWithoutExtent) {
  const auto maps = BuildVoxelMaps(std::vector<Eigen::Vector3f>(20, Eigen::Vector3f(1.2F, 3.4F, 5.6F)));
  for (const VoxelMap& map : maps) {
    ASSERT_EQ(map.surfels().size(), 1U);
    const Surfel& surfel = map.surfels()[0];
    EXPECT_EQ(surfel.count, 20);
    EXPECT_FALSE(surfel.has_normal);
    EXPECT_TRUE(surfel.normal.allFinite());
    EXPECT_LT((surfel.mean - Eigen::Vector3f(1.2F, 3.4F, 5.6F)).norm(), 1e-5F);
    EXPECT_GE(surfel.normal_variance, 0.0F);
  }
}

TEST(VoxelMapTest, TooFewPointsGiveNoElement) {
  const std::vector<Eigen::Vector3f> points(5, Eigen::Vector3f(1.2F, 3.4F, 5.6F));
  EXPECT_TRUE(BuildVoxelMaps(points)[0].surfels().empty());
  EXPECT_EQ(BuildVoxelMaps(points, {.min_points = 5})[0].surfels().size(), 1U);
}

TEST(VoxelMapTest, EmptyInputGivesEmptyLevels) {
  const auto maps = BuildVoxelMaps({});
  ASSERT_EQ(maps.size(), 3U);
  for (const VoxelMap& map : maps) {
    EXPECT_TRUE(map.surfels().empty());
    EXPECT_EQ(map.Find({0.0F, 0.0F, 0.0F}), -1);
  }
  EXPECT_EQ(VoxelMap().Find({0.0F, 0.0F, 0.0F}), -1);
}

TEST(VoxelMapTest, SkipsPointsThatAreNotFinite) {
  const auto clean = PatchPoints({.centre = {0.25, 0.25, 0.25}, .side_m = 0.4}, 50, 1);
  std::vector<Eigen::Vector3f> points = clean;
  points.insert(points.begin(), {kNan, 0.2F, 0.2F});
  points.insert(points.begin() + 20, {0.2F, kInfinity, 0.2F});
  points.push_back({0.2F, 0.2F, -kInfinity});
  const auto expected = BuildVoxelMaps(clean);
  const auto maps = BuildVoxelMaps(points);
  for (size_t level = 0; level < maps.size(); ++level) {
    ASSERT_EQ(maps[level].surfels().size(), expected[level].surfels().size());
    EXPECT_EQ(maps[level].surfels()[0].count, expected[level].surfels()[0].count);
    EXPECT_EQ(maps[level].surfels()[0].mean, expected[level].surfels()[0].mean);
  }
}

TEST(VoxelMapTest, SameBytesAtAnyThreadCount) {
  // More than one block of points, so that there is something to run in parallel.
  const auto points = PatchPoints({.centre = {1.0, 2.0, -1.5}, .side_m = 40.0, .noise_m = 0.1}, 150000, 5);
  testing::ExpectSameBytesAtAnyThreadCount([&](testing::ByteLog& log) {
    for (const VoxelMap& map : BuildVoxelMaps(points)) {
      for (const Surfel& surfel : map.surfels()) {
        log.Add(surfel.mean.data(), 3);
        log.Add(surfel.normal.data(), 3);
        log.Add(surfel.covariance.data(), 9);
        log.Add(surfel.first_point.data(), 3);
        log.Add(surfel.normal_variance);
        log.Add(surfel.count);
      }
    }
  });
}

}  // namespace
}  // namespace curvereg
