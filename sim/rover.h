// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A rover on four wheels: the ground under its wheels gives height, roll and pitch; its sensor stands on a mast.
//
// Rover frame: origin on the ground in the middle of the wheels, x ahead, y left, z along the mast.
#ifndef CURVEREG_SIM_ROVER_H_
#define CURVEREG_SIM_ROVER_H_

#include <Eigen/Core>
#include <array>
#include <optional>

#include "core/base/rigid_transform.h"
#include "sim/world.h"

namespace curvereg::sim {

struct RoverOptions {
  double wheelbase_m = 1.3;    // front to rear axle
  double track_m = 1.1;        // left to right wheel
  double mast_m = 1.8;         // sensor above the wheels' contacts
  double clearance_m = 1.4;    // no rock taller than max_rock_m may reach closer to the rover's middle where it stops
  double max_rock_m = 0.25;    // wheels climb what is smaller
  double max_tilt_rad = 0.17;  // it stops on level ground where there is some
};

struct RoverStance {
  RigidTransform T_world_rover = RigidTransform::Identity();
  std::array<Eigen::Vector3d, 4> contacts;  // front left, front right, rear left, rear right; on the surface
  double tilt_rad = 0.0;                    // of the mast from the vertical
};

// The stance at a place (x, y) [m] and heading [rad, counter-clockwise from world x]. The body is the least-squares
// plane of the four contacts, as a suspension averages them. Nullopt where a wheel finds no ground.
std::optional<RoverStance> StandOn(const World& world, const Eigen::Vector2d& place, double heading_rad,
                                   const RoverOptions& options);

// StandOn at the free place nearest to `place`: wheels on ground, no tall rock in the way, tilt within the limit; on
// steep ground the least tilted. Searches up to 8 m around; nullopt when there is none.
std::optional<RoverStance> ParkNear(const World& world, const Eigen::Vector2d& place, double heading_rad,
                                    const RoverOptions& options);

// Pose of the sensor on the mast, turned by sensor_yaw_rad about it.
RigidTransform SensorPose(const RoverStance& stance, const RoverOptions& options, double sensor_yaw_rad);

}  // namespace curvereg::sim

#endif  // CURVEREG_SIM_ROVER_H_
