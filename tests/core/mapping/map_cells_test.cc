// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/map_cells.h"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/core/mapping/map_scenes.h"

namespace curvereg {
namespace {

using testing::CellsOf;
using testing::MapScene;

TEST(MapCellsTest, CountsEachPointOnce) {
  const MapScene scene = testing::Strip(20, 3000);
  for (const std::size_t max_memory_bytes : {std::size_t{1} << 28, std::size_t{1} << 18}) {
    uint64_t num_points = 0;
    for (const MapCell& cell : CellsOf(scene, {.cell_m = 0.2, .max_memory_bytes = max_memory_bytes})) {
      num_points += cell.count;
      const Eigen::Vector3i index = (cell.mean.cast<double>() / 0.2).array().floor().cast<int>();
      EXPECT_EQ(index, cell.index);
    }
    EXPECT_EQ(num_points, 60000U);
  }
}

TEST(MapCellsTest, CoarserCellsTakeFewerPasses) {
  const MapScene scene = testing::Strip(40, 5000);
  const auto num_loads = [&](double cell_m) {
    scene.num_loads.assign(scene.num_loads.size(), 0);
    CellsOf(scene, {.cell_m = cell_m, .max_memory_bytes = std::size_t{1} << 18});
    return std::accumulate(scene.num_loads.begin(), scene.num_loads.end(), 0);
  };
  const int loads_of_coarse = num_loads(0.8);
  EXPECT_EQ(loads_of_coarse, 40) << "they fit";
  EXPECT_GT(num_loads(0.1), 2 * loads_of_coarse);
}

TEST(MapCellsTest, VotesAreTheSameInParts) {
  MapScene scene;
  for (int i = 0; i < 6; ++i) {
    const RigidTransform T = testing::RoverPose(3.0 * i, 0.0, 0.2 * i);
    testing::ScannerOptions scanner;
    scanner.num_columns = 360;
    scanner.noise_seed = static_cast<uint64_t>(i) + 1;
    Scan scan = testing::BumpyGround(T, scanner);
    for (int j = 0; j < 50; ++j)
      scan.points.emplace_back(2.0F + 0.01F * static_cast<float>(j), 0.1F * static_cast<float>(i), -0.3F);
    scene.Add(std::move(scan), T);
  }
  const PointMapOptions options{.cell_m = 0.1, .remove_dynamic = true};
  PointMapOptions in_parts = options;
  in_parts.max_memory_bytes = std::size_t{1} << 18;
  const auto expected = testing::PointsOf(scene, options);
  EXPECT_LT(expected.size(), testing::PointsOf(scene, {.cell_m = 0.1}).size());
  EXPECT_TRUE(testing::PointsOf(scene, in_parts) == expected);
}

}  // namespace
}  // namespace curvereg
