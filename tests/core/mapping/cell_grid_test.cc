// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/cell_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/testing/scenes.h"

namespace curvereg {
namespace {

TEST(CellGridTest, PointsLieInTheirCells) {
  testing::Random random(2);
  for (const double cell_m : {0.01, 0.1, 0.37, 10.0}) {
    const Eigen::Vector3d middle(1234.5, -6789.1, 12.3);
    const CellGrid grid(cell_m, middle);
    for (int i = 0; i < 2000; ++i) {
      const Eigen::Vector3d point =
          middle + Eigen::Vector3d(random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)) * 1e6 * cell_m;
      PlacedPoint placed;
      ASSERT_TRUE(grid.Place(point, &placed));
      EXPECT_LT(placed.key, CellGrid::kEndKey);
      const Eigen::Vector3d index = (point / cell_m).array().floor();
      EXPECT_LE((grid.IndexOf(placed.key) - index).cwiseAbs().maxCoeff(), 1e-9) << "cell " << cell_m;
      EXPECT_LE(placed.offset.cwiseAbs().maxCoeff(), 0.5F);
      const Eigen::Vector3d again = grid.Centre(placed.key) + placed.offset.cast<double>() * cell_m;
      EXPECT_LT((again - point).norm(), 1e-6 * cell_m + 1e-10);
    }
  }
}

TEST(CellGridTest, KeysOfATileShareTheirUpperBits) {
  const CellGrid grid(0.5, Eigen::Vector3d::Zero());
  PlacedPoint corner, opposite, outside;
  ASSERT_TRUE(grid.Place({8.1, -7.9, 0.1}, &corner));
  ASSERT_TRUE(grid.Place({15.9, -0.1, 7.9}, &opposite));
  ASSERT_TRUE(grid.Place({16.1, -0.1, 7.9}, &outside));
  EXPECT_EQ(corner.key >> 12, opposite.key >> 12);
  EXPECT_NE(corner.key >> 12, outside.key >> 12);
  EXPECT_LT((grid.Centre(corner.key, 4) - Eigen::Vector3d(12.0, -4.0, 4.0)).norm(), 1e-12);
  EXPECT_LT((grid.Centre(opposite.key, 4) - Eigen::Vector3d(12.0, -4.0, 4.0)).norm(), 1e-12);
}

TEST(CellGridTest, ReachesAMillionCells) {
  const CellGrid grid(0.1, Eigen::Vector3d(1000.0, 0.0, 0.0));
  PlacedPoint placed;
  EXPECT_TRUE(grid.Place({1000.0 + 104000.0, -104000.0, 104000.0}, &placed));
  EXPECT_FALSE(grid.Place({1000.0 + 105000.0, 0.0, 0.0}, &placed));
  EXPECT_FALSE(grid.Place({1000.0, -105000.0, 0.0}, &placed));
  EXPECT_FALSE(grid.Place({1e30, 0.0, 0.0}, &placed));
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (int axis = 0; axis < 3; ++axis) {
      Eigen::Vector3d point = Eigen::Vector3d::Zero();
      point[axis] = bad;
      EXPECT_FALSE(grid.Place(point, &placed)) << axis;
      EXPECT_FALSE(grid.Place(-point, &placed)) << axis;
    }
  }
}

}  // namespace
}  // namespace curvereg
