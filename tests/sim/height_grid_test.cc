// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/height_grid.h"

#include <gtest/gtest.h>

#include <cmath>

namespace curvereg::sim {
namespace {

TEST(HeightGridTest, SizeIsRoundedUpAndCentred) {
  const HeightGrid grid = MakeHeightGrid(10.0, 4.9, 0.5);
  EXPECT_EQ(grid.num_cells_x(), 20);
  EXPECT_EQ(grid.num_cells_y(), 10);
  EXPECT_DOUBLE_EQ(grid.x_min, -5.0);
  EXPECT_DOUBLE_EQ(grid.y_max(), 2.5);
}

TEST(HeightGridTest, BilinearPatch) {
  HeightGrid grid = MakeHeightGrid(1.0, 1.0, 1.0);  // one cell
  grid.heights(1, 1) = 4.0F;                        // h = 4 u v
  EXPECT_NEAR(grid.HeightAt(0.0, 0.0), 1.0, 1e-12);
  EXPECT_NEAR(grid.HeightAt(0.5, 0.0), 2.0, 1e-12);
  EXPECT_NEAR(grid.HeightAt(0.5, 0.5), 4.0, 1e-12);
  EXPECT_TRUE(std::isnan(grid.HeightAt(0.51, 0.0)));
  EXPECT_LT((grid.NormalAt(0.0, 0.0) - Eigen::Vector3d(-2.0, -2.0, 1.0).normalized()).norm(), 1e-12);
  // Along the diagonal u = v = s the patch is 4 s^2: a level ray at height 1 meets it at s = 1/2.
  const Ray ray = {.origin = {-0.5, -0.5, 1.0}, .direction = Eigen::Vector3d(1.0, 1.0, 0.0).normalized()};
  EXPECT_NEAR(grid.Intersect(ray, 0.0, std::sqrt(2.0)), std::sqrt(0.5), 1e-12);
}

TEST(HeightGridTest, LevelRayAboveMeetsNothing) {
  const HeightGrid grid = MakeHeightGrid(10.0, 10.0, 0.25);
  const Ray ray = {.origin = {-5.0, 0.0, 0.1}, .direction = Eigen::Vector3d::UnitX()};
  EXPECT_TRUE(std::isinf(grid.Intersect(ray, 0.0, 10.0)));
}

TEST(HeightGridTest, RaysAlongCellBordersAreNotLost) {
  const HeightGrid grid = MakeHeightGrid(10.0, 10.0, 0.25);
  for (int i = -20; i <= 20; ++i) {
    const Ray along_x = {.origin = {-5.0, 0.25 * i, 1.0}, .direction = Eigen::Vector3d(1.0, 0.0, -0.25).normalized()};
    EXPECT_NEAR(grid.Intersect(along_x, 0.0, 10.0), std::sqrt(17.0), 1e-9);
    const Ray down = {.origin = {0.25 * i, 0.0, 1.0}, .direction = -Eigen::Vector3d::UnitZ()};
    EXPECT_NEAR(grid.Intersect(down, 0.0, 10.0), 1.0, 1e-12);
  }
}

}  // namespace
}  // namespace curvereg::sim
