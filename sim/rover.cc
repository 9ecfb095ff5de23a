// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/rover.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace curvereg::sim {

std::optional<RoverStance> StandOn(const World& world, const Eigen::Vector2d& place, double heading_rad,
                                   const RoverOptions& options) {
  RoverStance stance;
  Eigen::Matrix3d R = Eigen::AngleAxisd(heading_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  // A tilted rover covers less ground seen from above; the wheels' places settle within micrometres.
  for (int iteration = 0; iteration < 4; ++iteration) {
    for (int wheel = 0; wheel < 4; ++wheel) {
      const double ahead = wheel < 2 ? 0.5 : -0.5;
      const double left = wheel % 2 == 0 ? 0.5 : -0.5;
      const Eigen::Vector2d at =
          place + (R * Eigen::Vector3d(ahead * options.wheelbase_m, left * options.track_m, 0.0)).head<2>();
      const double height = world.SurfaceHeight(at.x(), at.y());
      if (std::isnan(height)) return std::nullopt;
      stance.contacts[static_cast<std::size_t>(wheel)] = {at.x(), at.y(), height};
    }
    const auto& [front_left, front_right, rear_left, rear_right] = stance.contacts;
    const Eigen::Vector3d ahead = (front_left + front_right - rear_left - rear_right).normalized();
    const Eigen::Vector3d left = front_left + rear_left - front_right - rear_right;
    const Eigen::Vector3d up = ahead.cross(left).normalized();
    R << ahead, up.cross(ahead), up;
    stance.T_world_rover.translation() = 0.25 * (front_left + front_right + rear_left + rear_right);
  }
  stance.T_world_rover.linear() = R;
  stance.tilt_rad = std::acos(std::clamp(R(2, 2), -1.0, 1.0));
  return stance;
}

std::optional<RoverStance> ParkNear(const World& world, const Eigen::Vector2d& place, double heading_rad,
                                    const RoverOptions& options) {
  constexpr double kRingStep = 0.4;
  constexpr int kNumRings = 20;
  constexpr int kNumDirections = 10;
  std::optional<RoverStance> least_tilted;
  for (int ring = 0; ring <= kNumRings; ++ring) {
    for (int i = 0; i < (ring == 0 ? 1 : kNumDirections); ++i) {
      // Sideways first: the distance driven stays what was planned.
      const double direction = heading_rad + std::numbers::pi * (0.5 + 2.0 * i / kNumDirections);
      const Eigen::Vector2d at = place + kRingStep * ring * Eigen::Vector2d(std::cos(direction), std::sin(direction));
      if (!world.IsClearOfRocks(at, options.clearance_m, options.max_rock_m)) continue;
      const std::optional<RoverStance> stance = StandOn(world, at, heading_rad, options);
      if (!stance.has_value()) continue;
      if (stance->tilt_rad <= options.max_tilt_rad) return stance;
      if (!least_tilted.has_value() || stance->tilt_rad < least_tilted->tilt_rad) least_tilted = stance;
    }
  }
  return least_tilted;
}

RigidTransform SensorPose(const RoverStance& stance, const RoverOptions& options, double sensor_yaw_rad) {
  return stance.T_world_rover * Eigen::Translation3d(0.0, 0.0, options.mast_m) *
         Eigen::AngleAxisd(sensor_yaw_rad, Eigen::Vector3d::UnitZ());
}

}  // namespace curvereg::sim
