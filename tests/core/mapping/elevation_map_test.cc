// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/elevation_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "sim/elevation_model.h"
#include "tests/core/mapping/map_scenes.h"

namespace curvereg {
namespace {

using testing::HasCode;
using testing::IsOk;
using testing::MapScene;

ElevationMap MapOf(const MapScene& scene, const PointMapOptions& options) {
  absl::StatusOr<ElevationMap> map = BuildElevationMap(scene.Input(), options);
  EXPECT_THAT(map, IsOk());
  return map.ok() ? *std::move(map) : ElevationMap{};
}

float HeightAt(const ElevationMap& map, double x, double y) {
  const int column = static_cast<int>(std::floor((x - map.min_x_m) / map.cell_m));
  const int row = map.num_rows - 1 - static_cast<int>(std::floor((y - map.min_y_m) / map.cell_m));
  return map.heights[static_cast<std::size_t>(row * map.num_columns + column)];
}

std::string TextOf(const ElevationMap& map) {
  std::string text;
  EXPECT_THAT(WriteEsriAscii(map,
                             [&](std::string_view piece) {
                               text += piece;
                               return absl::OkStatus();
                             }),
              IsOk());
  return text;
}

// Three seen columns of a 3 x 2 grid.
MapScene FewPoints() {
  MapScene scene;
  scene.Add(
      {.points = {{0.5F, 0.5F, 1.0F}, {0.6F, 0.4F, 2.0F}, {0.5F, 0.5F, 3.0F}, {2.5F, 1.5F, -4.0F}}, .gravity = {}},
      RigidTransform::Identity());
  scene.Add({.points = {{0.5F, 0.5F, 8.0F}}, .gravity = {}}, testing::UprightPose(0.0, 1.0, 0.0, 0.0));
  return scene;
}

TEST(ElevationMapTest, HasTheMeanHeightOfEachColumnFromTheNorth) {
  const ElevationMap map = MapOf(FewPoints(), {.cell_m = 1.0});
  EXPECT_EQ(map.num_columns, 3);
  EXPECT_EQ(map.num_rows, 2);
  EXPECT_EQ(map.cell_m, 1.0);
  EXPECT_EQ(map.min_x_m, 0.0);
  EXPECT_EQ(map.min_y_m, 0.0);
  ASSERT_EQ(map.heights.size(), 6U);
  EXPECT_NEAR(map.heights[0], 8.0, 1e-6);
  EXPECT_TRUE(std::isnan(map.heights[1]));
  EXPECT_NEAR(map.heights[2], -4.0, 1e-6);
  EXPECT_NEAR(map.heights[3], 2.0, 1e-6) << "points 1, 2 and 3 m high";
  EXPECT_TRUE(std::isnan(map.heights[4]));
  EXPECT_TRUE(std::isnan(map.heights[5]));
}

TEST(ElevationMapTest, FollowsTheGround) {
  const ElevationMap map = MapOf(testing::Strip(10, 4000), {.cell_m = 0.25});
  int num_seen = 0;
  for (int row = 0; row < map.num_rows; ++row) {
    for (int column = 0; column < map.num_columns; ++column) {
      const float height = map.heights[static_cast<std::size_t>(row * map.num_columns + column)];
      if (std::isnan(height)) continue;
      ++num_seen;
      const double x = map.min_x_m + (column + 0.5) * map.cell_m;
      const double y = map.min_y_m + (map.num_rows - row - 0.5) * map.cell_m;
      // Slopes are at most 0.16; points lie up to 0.18 m off the middle.
      EXPECT_NEAR(height, 0.4 * std::sin(0.3 * x) + 0.2 * std::cos(0.5 * y), 0.03);
    }
  }
  EXPECT_GT(num_seen, 9000);
}

TEST(ElevationMapTest, CoarserCellsAreMeansOverThePointsOfTheFiner) {
  const MapScene scene = testing::Strip(4, 3000);
  const ElevationMap coarse = MapOf(scene, {.cell_m = 0.2});
  std::vector<double> sums(coarse.heights.size(), 0.0), counts(coarse.heights.size(), 0.0);
  const ElevationMap fine = MapOf(scene, {.cell_m = 0.1});
  std::vector<double> fine_counts(fine.heights.size(), 0.0);
  for (std::size_t i = 0; i < scene.scans.size(); ++i) {
    for (const Eigen::Vector3f& point : scene.scans[i]->points) {
      const Eigen::Vector3d at = scene.T_map_scan[i] * point.cast<double>();
      const int column = static_cast<int>(std::floor(at.x() / 0.2) - std::round(coarse.min_x_m / 0.2));
      const int row =
          coarse.num_rows - 1 - static_cast<int>(std::floor(at.y() / 0.2) - std::round(coarse.min_y_m / 0.2));
      const auto cell = static_cast<std::size_t>(row * coarse.num_columns + column);
      sums[cell] += static_cast<double>(HeightAt(fine, at.x(), at.y()));
      counts[cell] += 1.0;
    }
  }
  int num_seen = 0;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    EXPECT_EQ(std::isnan(coarse.heights[i]), counts[i] == 0.0);
    if (counts[i] == 0.0) continue;
    ++num_seen;
    // The points' fine cells, each as often as it has points.
    EXPECT_NEAR(coarse.heights[i], sums[i] / counts[i], 1e-4);
  }
  EXPECT_GT(num_seen, 5000);
}

TEST(ElevationMapTest, LittleMemoryGivesTheSameGridOrNone) {
  const MapScene scene = testing::Strip(20, 4000);
  const ElevationMap whole = MapOf(scene, {.cell_m = 0.2});
  const ElevationMap in_parts = MapOf(scene, {.cell_m = 0.2, .max_memory_bytes = std::size_t{3} << 20});
  EXPECT_EQ(TextOf(in_parts), TextOf(whole));
  EXPECT_THAT(BuildElevationMap(scene.Input(), {.cell_m = 0.2, .max_memory_bytes = std::size_t{1} << 18}),
              HasCode(absl::StatusCode::kResourceExhausted));
  // Two points far apart span a grid of 10^12 cells.
  MapScene far = FewPoints();
  far.Add({.points = {{5e4F, 5e4F, 0.0F}}, .gravity = {}}, RigidTransform::Identity());
  EXPECT_THAT(BuildElevationMap(far.Input(), {.cell_m = 0.1}), HasCode(absl::StatusCode::kResourceExhausted));
  EXPECT_EQ(MapOf(far, {.cell_m = 1.0, .max_range_m = 100.0}).heights.size(), 6U);
}

TEST(ElevationMapTest, NothingSeenIsAnEmptyGrid) {
  const ElevationMap map = MapOf({}, {.cell_m = 0.5});
  EXPECT_EQ(map.num_columns, 0);
  EXPECT_EQ(map.num_rows, 0);
  EXPECT_EQ(TextOf(map),
            "ncols 0\nnrows 0\nxllcorner 0.000000\nyllcorner 0.000000\ncellsize 0.500000\nNODATA_value -9999\n");
}

TEST(WriteEsriAsciiTest, HasTheFormatsLines) {
  EXPECT_EQ(TextOf(MapOf(FewPoints(), {.cell_m = 1.0})),
            "ncols 3\nnrows 2\nxllcorner 0.000000\nyllcorner 0.000000\ncellsize 1.000000\nNODATA_value -9999\n"
            "8.0000 -9999 -4.0000\n2.0000 -9999 -9999\n");
}

TEST(WriteEsriAsciiTest, IsReadBack) {
  const ElevationMap map = MapOf(testing::Strip(3, 2000), {.cell_m = 0.25});
  const absl::StatusOr<sim::HeightGrid> grid = sim::ParseEsriAsciiGrid(TextOf(map), "map");
  ASSERT_THAT(grid, IsOk());
  EXPECT_EQ(grid->cell, 0.25);
  ASSERT_EQ(grid->heights.cols, map.num_columns);
  ASSERT_EQ(grid->heights.rows, map.num_rows);
  // The reader takes the mean off and counts rows from the south.
  double mean = 0.0;
  int num_seen = 0;
  for (const float height : map.heights) {
    if (!std::isnan(height)) mean += static_cast<double>(height), ++num_seen;
  }
  mean /= num_seen;
  for (int row = 0; row < map.num_rows; ++row) {
    for (int column = 0; column < map.num_columns; ++column) {
      const float written = map.heights[static_cast<std::size_t>(row * map.num_columns + column)];
      const float read = grid->heights(map.num_rows - 1 - row, column);
      EXPECT_EQ(std::isnan(read), std::isnan(written));
      if (!std::isnan(written)) {
        EXPECT_NEAR(static_cast<double>(read) + mean, static_cast<double>(written), 1e-4);
      }
    }
  }
}

TEST(WriteEsriAsciiTest, ErrorsOfTheSinkEndIt) {
  const auto refuse = [](std::string_view) { return absl::UnavailableError("full"); };
  EXPECT_THAT(WriteEsriAscii(MapOf(FewPoints(), {.cell_m = 1.0}), refuse), HasCode(absl::StatusCode::kUnavailable));
}

}  // namespace
}  // namespace curvereg
