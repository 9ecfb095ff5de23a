// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/point_map.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "tests/core/mapping/map_scenes.h"
#include "tests/testing/same_bytes.h"

namespace curvereg {
namespace {

using testing::HasCode;
using testing::MapScene;
using testing::PointsOf;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

bool SamePoints(const std::vector<Eigen::Vector3f>& a, const std::vector<Eigen::Vector3f>& b) { return a == b; }

// Means per cell by the plainest means.
std::map<std::array<int, 3>, Eigen::Vector3d> MeansPerCell(const MapScene& scene, double cell_m) {
  std::map<std::array<int, 3>, std::pair<Eigen::Vector3d, int>> sums;
  for (std::size_t i = 0; i < scene.scans.size(); ++i) {
    for (const Eigen::Vector3f& point : scene.scans[i]->points) {
      const Eigen::Vector3d at = scene.T_map_scan[i] * point.cast<double>();
      const Eigen::Vector3i cell = (at / cell_m).array().floor().cast<int>();
      auto& [sum, count] = sums.try_emplace({cell.x(), cell.y(), cell.z()}, Eigen::Vector3d::Zero(), 0).first->second;
      sum += at;
      ++count;
    }
  }
  std::map<std::array<int, 3>, Eigen::Vector3d> means;
  for (const auto& [cell, sum] : sums) means[cell] = sum.first / sum.second;
  return means;
}

TEST(PointMapTest, HasTheMeanOfEachCell) {
  const MapScene scene = testing::Strip(5, 4000);
  const auto expected = MeansPerCell(scene, 0.3);
  const auto points = PointsOf(scene, {.cell_m = 0.3});
  ASSERT_EQ(points.size(), expected.size());
  ASSERT_LT(points.size(), 12000U) << "cells ought to hold several points";
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3i cell = (point.cast<double>() / 0.3).array().floor().cast<int>();
    const auto mean = expected.find({cell.x(), cell.y(), cell.z()});
    ASSERT_NE(mean, expected.end());
    EXPECT_LT((point.cast<double>() - mean->second).norm(), 1e-5);
  }
}

TEST(PointMapTest, CellsOfTwiceTheSizeAreMeansOfTheFiner) {
  const MapScene scene = testing::Strip(5, 4000);
  const std::vector<MapCell> fine = testing::CellsOf(scene, {.cell_m = 0.1});
  std::map<std::array<int, 3>, std::pair<Eigen::Vector3d, uint32_t>> sums;
  for (const MapCell& cell : fine) {
    const Eigen::Vector3i parent = (cell.index.cast<double>() / 2.0).array().floor().cast<int>();
    auto& [sum, count] =
        sums.try_emplace({parent.x(), parent.y(), parent.z()}, Eigen::Vector3d::Zero(), 0).first->second;
    sum += cell.mean.cast<double>() * cell.count;
    count += cell.count;
  }
  const std::vector<MapCell> coarse = testing::CellsOf(scene, {.cell_m = 0.2});
  ASSERT_EQ(coarse.size(), sums.size());
  ASSERT_LT(2 * coarse.size(), 3 * fine.size());
  for (const MapCell& cell : coarse) {
    const auto& [sum, count] = sums.at({cell.index.x(), cell.index.y(), cell.index.z()});
    EXPECT_EQ(cell.count, count);
    EXPECT_LT((cell.mean.cast<double>() - sum / count).norm(), 1e-5);
  }
}

TEST(PointMapTest, LittleMemoryGivesTheSamePointsInTheSameOrder) {
  // Some 200,000 cells; 1 MB holds 29,000 of them.
  const MapScene scene = testing::Strip(100, 8000);
  const auto at_once = PointsOf(scene, {.cell_m = 0.1, .max_memory_bytes = std::size_t{256} << 20});
  EXPECT_GT(at_once.size(), 150000U);
  for (const int num_loads : scene.num_loads) EXPECT_EQ(num_loads, 1);
  scene.num_loads.assign(scene.num_loads.size(), 0);
  const auto in_parts = PointsOf(scene, {.cell_m = 0.1, .max_memory_bytes = std::size_t{1} << 20});
  EXPECT_TRUE(SamePoints(in_parts, at_once));
  // Scans are asked for again where they have points, not for each of the two dozen parts.
  int most_loads = 0, sum = 0;
  for (const int num_loads : scene.num_loads) {
    most_loads = std::max(most_loads, num_loads);
    sum += num_loads;
  }
  EXPECT_GT(most_loads, 1);
  EXPECT_LE(sum, 800);
  // The smallest that is taken, in the middle of tiles.
  EXPECT_TRUE(SamePoints(PointsOf(testing::Strip(12, 2000), {.max_memory_bytes = std::size_t{1} << 16}),
                         PointsOf(testing::Strip(12, 2000), {})));
}

TEST(PointMapTest, PointsThatAreNotFiniteOrTooFarAreLeftOut) {
  MapScene scene;
  scene.Add(
      {.points =
           {{1.0F, 0.0F, 0.0F}, {kNan, 0.0F, 0.0F}, {kInfinity, 1.0F, 1.0F}, {0.0F, 30.5F, 0.0F}, {0.0F, 29.5F, 0.0F}},
       .gravity = {}},
      testing::UprightPose(100.0, 0.0, 0.0));
  EXPECT_EQ(PointsOf(scene, {}).size(), 3U);
  EXPECT_EQ(PointsOf(scene, {.max_range_m = 30.0}).size(), 2U);
}

TEST(PointMapTest, OutliersFarOutCostNothing) {
  MapScene scene = testing::Strip(3, 3000);
  const auto clean = PointsOf(scene, {.cell_m = 0.01});
  Scan outliers;
  testing::Random random(3);
  for (int i = 0; i < 200; ++i) {
    outliers.points.push_back(
        Eigen::Vector3f::NullaryExpr([&] { return static_cast<float>(random.Uniform(-9e4, 9e4)); }));
  }
  outliers.points.push_back(Eigen::Vector3f::Constant(3e38F));
  scene.Add(std::move(outliers), testing::UprightPose(0.0, 0.0, 0.0));
  const auto points = PointsOf(scene, {.cell_m = 0.01});
  EXPECT_GE(points.size(), clean.size());
  EXPECT_LE(points.size(), clean.size() + 201);
  // At 10 m all of the reach counts.
  EXPECT_GE(PointsOf(scene, {.cell_m = 10.0}).size(), 200U);
}

TEST(PointMapTest, PointsFarApartKeepTheirPlaces) {
  MapScene scene;
  for (const double x : {-5000.0, 5000.0}) {
    scene.Add({.points = {{1.26F, 2.26F, -0.26F}}, .gravity = {}}, testing::UprightPose(x, 3.0, 0.0, 0.0));
  }
  const auto points = PointsOf(scene, {.cell_m = 0.05});
  ASSERT_EQ(points.size(), 2U);
  EXPECT_LT((points[0] - Eigen::Vector3f(-4998.74F, 5.26F, -0.26F)).norm(), 1e-3F);
  EXPECT_LT((points[1] - Eigen::Vector3f(5001.26F, 5.26F, -0.26F)).norm(), 1e-3F);
}

TEST(PointMapTest, SameBytesAtAnyThreadCount) {
  const MapScene scene = testing::Strip(6, 3000);
  testing::ExpectSameBytesAtAnyThreadCount([&](testing::ByteLog& log) {
    const auto points = PointsOf(scene, {.remove_dynamic = true});
    for (const Eigen::Vector3f& point : points) log.Add(point.data(), 3);
  });
}

TEST(PointMapTest, NothingGivesNothing) {
  MapScene scene;
  EXPECT_TRUE(PointsOf(scene, {}).empty());
  scene.Add({}, RigidTransform::Identity());
  scene.Add({.points = {{kNan, kNan, kNan}}, .gravity = {}}, RigidTransform::Identity());
  EXPECT_TRUE(PointsOf(scene, {}).empty());
  EXPECT_TRUE(PointsOf(scene, {.remove_dynamic = true}).empty());
}

TEST(PointMapTest, OptionsAndPosesAreChecked) {
  MapScene scene = testing::Strip(1, 10);
  const auto ignore = [](std::span<const Eigen::Vector3f>) { return absl::OkStatus(); };
  const auto invalid = HasCode(absl::StatusCode::kInvalidArgument);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double cell_m : {0.0, 0.009, 10.1, -1.0, nan}) {
    EXPECT_THAT(BuildPointMap(scene.Input(), {.cell_m = cell_m}, ignore), invalid) << cell_m;
  }
  EXPECT_THAT(BuildPointMap(scene.Input(), {.max_range_m = -1.0}, ignore), invalid);
  EXPECT_THAT(BuildPointMap(scene.Input(), {.max_range_m = nan}, ignore), invalid);
  EXPECT_THAT(BuildPointMap(scene.Input(), {.max_memory_bytes = 65535}, ignore), invalid);
  EXPECT_THAT(BuildPointMap({scene.T_map_scan, nullptr}, {}, ignore), invalid);
  scene.T_map_scan[0].translation().x() = 2e7;
  EXPECT_THAT(BuildPointMap(scene.Input(), {}, ignore), invalid);
  scene.T_map_scan[0] = RigidTransform::Identity();
  scene.T_map_scan[0].linear() *= 1.1;
  EXPECT_THAT(BuildPointMap(scene.Input(), {}, ignore), invalid);
}

TEST(PointMapTest, ErrorsOfLoaderAndSinkEndIt) {
  const MapScene scene = testing::Strip(3, 10);
  int num_pieces = 0;
  const auto count = [&](std::span<const Eigen::Vector3f>) {
    ++num_pieces;
    return absl::OkStatus();
  };
  const MapInput broken{scene.T_map_scan,
                        [&](std::size_t index, const Stop&) -> absl::StatusOr<std::shared_ptr<const Scan>> {
                          if (index == 2) return absl::DataLossError("damaged");
                          return scene.scans[index];
                        }};
  EXPECT_THAT(BuildPointMap(broken, {}, count), HasCode(absl::StatusCode::kDataLoss));
  EXPECT_EQ(num_pieces, 0);
  const auto refuse = [](std::span<const Eigen::Vector3f>) { return absl::UnavailableError("full"); };
  EXPECT_THAT(BuildPointMap(scene.Input(), {}, refuse), HasCode(absl::StatusCode::kUnavailable));
}

TEST(PointMapTest, StopsWhenAsked) {
  const MapScene scene = testing::Strip(3, 10);
  const auto ignore = [](std::span<const Eigen::Vector3f>) { return absl::OkStatus(); };
  std::stop_source source;
  source.request_stop();
  EXPECT_THAT(BuildPointMap(scene.Input(), {}, ignore, {.cancellation = source.get_token(), .deadline = {}}),
              HasCode(absl::StatusCode::kCancelled));
  EXPECT_THAT(
      BuildPointMap(scene.Input(), {}, ignore, {.cancellation = {}, .deadline = std::chrono::steady_clock::now()}),
      HasCode(absl::StatusCode::kDeadlineExceeded));
  EXPECT_EQ(scene.num_loads[0], 0);
}

}  // namespace
}  // namespace curvereg
