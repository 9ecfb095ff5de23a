// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/rover.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sim/yard_world.h"

namespace curvereg::sim {
namespace {

TEST(RoverTest, StandsAlongASlope) {
  HeightGrid grid = MakeHeightGrid(20.0, 20.0, 0.5);
  for (int row = 0; row < grid.heights.rows; ++row) {
    for (int col = 0; col < grid.heights.cols; ++col) {
      grid.heights(row, col) = static_cast<float>(0.2 * (grid.x_min + grid.cell * col));
    }
  }
  const World slope(grid, {});
  const RoverOptions options;
  const std::optional<RoverStance> uphill = StandOn(slope, {1.0, 2.0}, 0.0, options);
  ASSERT_TRUE(uphill.has_value());
  EXPECT_NEAR(uphill->tilt_rad, std::atan(0.2), 1e-6);
  EXPECT_LT((uphill->T_world_rover.translation() - Eigen::Vector3d(1.0, 2.0, 0.2)).norm(), 1e-6);
  EXPECT_TRUE(IsRigid(uphill->T_world_rover, 1e-12));
  const Eigen::Vector3d ahead = uphill->T_world_rover.linear().col(0);
  EXPECT_LT((ahead - Eigen::Vector3d(1.0, 0.0, 0.2).normalized()).norm(), 1e-6);
  // The wheels stand a wheelbase and a track apart on the slope, not on the map.
  EXPECT_NEAR((uphill->contacts[0] - uphill->contacts[2]).norm(), options.wheelbase_m, 1e-6);
  EXPECT_NEAR((uphill->contacts[0] - uphill->contacts[1]).norm(), options.track_m, 1e-6);
  // The mast leans back with the rover.
  const Eigen::Vector3d sensor = SensorPose(*uphill, options, 0.3).translation();
  const Eigen::Vector3d normal = Eigen::Vector3d(-0.2, 0.0, 1.0).normalized();
  EXPECT_LT((sensor - Eigen::Vector3d(1.0, 2.0, 0.2) - options.mast_m * normal).norm(), 1e-6);
}

TEST(RoverTest, SensorYawTurnsAboutTheMast) {
  const World plain(MakeHeightGrid(20.0, 20.0, 0.5), {});
  const std::optional<RoverStance> stance = StandOn(plain, {0.0, 0.0}, 0.5, {});
  ASSERT_TRUE(stance.has_value());
  const Eigen::Matrix3d R = SensorPose(*stance, {}, 0.7).linear();
  EXPECT_LT((R - RotationFromVector({0.0, 0.0, 1.2})).norm(), 1e-12);
}

TEST(RoverTest, WheelsTouchTheGround) {
  const World yard = MakeYardWorld({}, 1.0, 6);
  const RoverOptions options;
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector2d place(-50.0 + 2.5 * i, 20.0 * std::sin(i));
    const std::optional<RoverStance> stance = ParkNear(yard, place, 0.3 * i, options);
    ASSERT_TRUE(stance.has_value());
    EXPECT_LT((stance->T_world_rover.translation().head<2>() - place).norm(), 8.1);
    EXPECT_LE(stance->tilt_rad, options.max_tilt_rad);
    double sum = 0.0;
    for (const Eigen::Vector3d& contact : stance->contacts) {
      EXPECT_NEAR(contact.z(), yard.SurfaceHeight(contact.x(), contact.y()), 1e-9);
      const double off_body = (stance->T_world_rover.inverse() * contact).z();
      EXPECT_LT(std::abs(off_body), 0.15) << "within the suspension's travel";
      sum += off_body;
    }
    EXPECT_NEAR(sum, 0.0, 1e-9) << "the body averages its wheels";
    const Eigen::Vector2d middle = stance->T_world_rover.translation().head<2>();
    EXPECT_TRUE(yard.IsClearOfRocks(middle, options.clearance_m - 0.05, options.max_rock_m));
  }
}

TEST(RoverTest, AvoidsARockAndGivesUpWithoutGround) {
  Rock rock;
  rock.centre = {0.0, 0.0, 0.0};
  const World world(MakeHeightGrid(20.0, 20.0, 0.5), {rock});
  const std::optional<RoverStance> stance = ParkNear(world, {0.0, 0.0}, 0.0, {});
  ASSERT_TRUE(stance.has_value());
  const double distance = stance->T_world_rover.translation().head<2>().norm();
  EXPECT_GT(distance, 2.39);
  EXPECT_LT(distance, 2.9);
  EXPECT_FALSE(StandOn(world, {9.9, 0.0}, 0.0, {}).has_value()) << "a wheel over the edge";
  HeightGrid holes = MakeHeightGrid(30.0, 30.0, 1.0);
  std::fill(holes.heights.pixels.begin(), holes.heights.pixels.end(), std::numeric_limits<float>::quiet_NaN());
  EXPECT_FALSE(ParkNear(World(holes, {}), {0.0, 0.0}, 0.0, {}).has_value());
}

}  // namespace
}  // namespace curvereg::sim
