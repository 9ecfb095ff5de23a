// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A small uneven ground with a few large rocks, small enough for the baselines to register in a second.
#ifndef CURVEREG_TESTS_CORE_BASELINES_BUMPY_GROUND_H_
#define CURVEREG_TESTS_CORE_BASELINES_BUMPY_GROUND_H_

#include <array>
#include <cmath>
#include <cstdint>
#include <random>

#include "core/base/rigid_transform.h"
#include "core/scan/scan.h"

namespace curvereg::testing {

// Height [m] of the ground at (x, y) [m], world frame.
inline double BumpyHeight(double x, double y) {
  double z = 0.5 * std::sin(0.37 * x) * std::cos(0.29 * y + 0.5) + 0.1 * std::sin(1.3 * x + 0.9 * y);
  constexpr std::array<std::array<double, 4>, 7> kBumps = {{{-6.0, 3.0, 1.6, 0.9},  // x, y, height, radius
                                                            {2.0, -5.0, 2.1, 1.2},
                                                            {5.5, 4.5, 1.2, 0.8},
                                                            {-3.0, -7.0, 0.9, 0.7},
                                                            {0.5, 6.5, 1.8, 1.5},
                                                            {7.0, -2.0, 1.4, 0.6},
                                                            {-8.0, -3.0, 2.0, 1.0}}};
  for (const auto& [bump_x, bump_y, height, radius] : kBumps) {
    const double squared = (std::pow(x - bump_x, 2) + std::pow(y - bump_y, 2)) / (radius * radius);
    z += height * std::exp(-squared * squared);
  }
  return z;
}

// About `num_points` samples of the ground within 10 m of the world's origin, at places drawn with `seed`, as a sensor
// at `T_world_sensor` sees them (without occlusion).
inline Scan BumpyScan(const RigidTransform& T_world_sensor, uint64_t seed, int num_points = 5000) {
  std::mt19937_64 generator(seed);
  const auto uniform = [&] { return static_cast<double>(generator() >> 11U) * 0x1p-53; };
  const RigidTransform T_sensor_world = T_world_sensor.inverse();
  Scan scan;
  for (int i = 0; i < num_points; ++i) {
    const double x = -10.0 + 20.0 * uniform();
    const double y = -10.0 + 20.0 * uniform();
    scan.points.emplace_back((T_sensor_world * Eigen::Vector3d(x, y, BumpyHeight(x, y))).cast<float>());
  }
  return scan;
}

// A sensor `height_m` above the origin's ground, moved by (dx, dy) and turned by yaw.
inline RigidTransform SensorPose(double dx, double dy, double yaw, double height_m = 2.0) {
  RigidTransform T_world_sensor = RigidTransform::Identity();
  T_world_sensor.linear() = RotationFromVector({0.01, -0.02, yaw});
  T_world_sensor.translation() = Eigen::Vector3d(dx, dy, height_m);
  return T_world_sensor;
}

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_CORE_BASELINES_BUMPY_GROUND_H_
