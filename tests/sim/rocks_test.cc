// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/rocks.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "sim/random.h"

namespace curvereg::sim {
namespace {

TEST(RocksTest, UnitBall) {
  const Rock ball;
  EXPECT_NEAR(ball.Intersect({.origin = {-3.0, 0.0, 0.0}, .direction = Eigen::Vector3d::UnitX()}), 2.0, 1e-12);
  EXPECT_TRUE(std::isinf(ball.Intersect({.origin = {-3.0, 1.1, 0.0}, .direction = Eigen::Vector3d::UnitX()})));
  EXPECT_TRUE(std::isinf(ball.Intersect({.origin = {3.0, 0.0, 0.0}, .direction = Eigen::Vector3d::UnitX()})));
  EXPECT_LT((ball.NormalAt({0.0, 1.0, 0.0}) - Eigen::Vector3d::UnitY()).norm(), 1e-12);
}

TEST(RocksTest, PowerLawSizesOnTheGround) {
  const HeightGrid grid = MakeHeightGrid(200.0, 100.0, 1.0);
  const RockOptions options = {.density_per_m2 = 1.0, .num_boulders = 3};
  const std::vector<Rock> rocks = ScatterRocks(grid, options, 1.0, 4);
  ASSERT_EQ(rocks.size(), 20'003U);
  int wider = 0;
  for (const Rock& rock : rocks) {
    // The long axis belongs to the smallest singular value of the map to the unit ball.
    const Eigen::Matrix3d squared = rock.to_unit.transpose() * rock.to_unit;
    const double diameter = 2.0 / std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(squared).eigenvalues()[0]);
    EXPECT_GE(diameter, options.min_diameter_m - 1e-9);
    if (diameter > 0.2) ++wider;
    EXPECT_LT(std::abs(rock.centre.z()), rock.half_extent.z()) << "neither buried nor floating";
  }
  // N(> 2 d_min) / N = 2^-2, less what the cut at the largest diameter takes.
  EXPECT_NEAR(wider / 20'000.0, 0.246, 0.012);
}

TEST(RocksTest, BoundingBoxHoldsTheSurface) {
  const std::vector<Rock> rocks = ScatterRocks(MakeHeightGrid(20.0, 20.0, 1.0), {}, 0.7, 8);
  RandomStream random(2);
  for (const Rock& rock : rocks) {
    const Eigen::Vector3d unit = Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal()).normalized();
    const Eigen::Vector3d offset = rock.to_unit.inverse() * unit;
    EXPECT_TRUE((offset.cwiseAbs().array() <= rock.half_extent.array() + 1e-9).all());
  }
}

TEST(RocksTest, NoneInHolesAndNoneAskedFor) {
  HeightGrid grid = MakeHeightGrid(10.0, 10.0, 1.0);
  EXPECT_TRUE(ScatterRocks(grid, {.density_per_m2 = 0.0, .num_boulders = 0}, 1.0, 1).empty());
  std::fill(grid.heights.pixels.begin(), grid.heights.pixels.end(), std::nanf(""));
  EXPECT_TRUE(ScatterRocks(grid, {.density_per_m2 = 1.0}, 1.0, 1).empty());
}

}  // namespace
}  // namespace curvereg::sim
