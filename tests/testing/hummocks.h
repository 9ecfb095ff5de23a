// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A small synthetic scene for methods that see panoramas: hummocky ground and an ideal scanner on a mast above it.
#ifndef CURVEREG_TESTS_TESTING_HUMMOCKS_H_
#define CURVEREG_TESTS_TESTING_HUMMOCKS_H_

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/rigid_transform.h"
#include "core/scan/scan.h"

namespace curvereg::testing {

// Hummocks of many sizes, without a period that the scan could meet.
inline double HummockHeightAt(double x, double y) {
  double height = 0.0;
  for (int i = 1; i <= 12; ++i) {
    const double angle = 2.4 * i;
    const double wavelength = 3.0 + 1.7 * i;
    height += 0.035 * wavelength *
              std::sin((x * std::cos(angle) + y * std::sin(angle)) * 2.0 * std::numbers::pi / wavelength + 1.1 * i * i);
  }
  return height;
}

// The first place where the ray meets the ground, by small steps and halving; NaN beyond 50 m.
inline Eigen::Vector3d CastOnHummocks(const Eigen::Vector3d& origin, const Eigen::Vector3d& beam) {
  const auto is_above = [&](double range) {
    const Eigen::Vector3d point = origin + range * beam;
    return point.z() > HummockHeightAt(point.x(), point.y());
  };
  constexpr double kStep = 0.5;
  for (double range = 1.0; range < 50.0; range += kStep) {
    if (is_above(range)) continue;
    double low = range - kStep, high = range;
    for (int i = 0; i < 20; ++i) (is_above(0.5 * (low + high)) ? low : high) = 0.5 * (low + high);
    return origin + high * beam;
  }
  return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
}

// A scanner of half a degree, 45 degrees high, that looks at the hummocks.
inline Scan ScanHummocks(const RigidTransform& T_world_scan) {
  Scan scan;
  for (int row = 0; row < 90; ++row) {
    const double elevation = (7.25 - 0.5 * row) * std::numbers::pi / 180.0;
    for (int col = 0; col < 720; ++col) {
      const double azimuth = (0.5 * col + 0.25) * std::numbers::pi / 180.0;
      const Eigen::Vector3d beam(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                 std::sin(elevation));
      const Eigen::Vector3d point = CastOnHummocks(T_world_scan.translation(), T_world_scan.linear() * beam);
      scan.points.push_back((T_world_scan.inverse() * point).cast<float>());
    }
  }
  return scan;
}

// A sensor 4 m above the mean ground.
inline RigidTransform Mast(double x, double y, double yaw_rad) {
  RigidTransform T_world_scan = RigidTransform::Identity();
  T_world_scan.linear() = RotationFromVector({0.0, 0.0, yaw_rad});
  T_world_scan.translation() = Eigen::Vector3d(x, y, 4.0);
  return T_world_scan;
}

struct TwoScans {
  Scan source;
  Scan target;
  RigidTransform T_target_source;
};

// Two scans a third of a metre apart; made once.
inline const TwoScans& SmallMotion() {
  static const TwoScans scans = [] {
    const RigidTransform T_world_target = Mast(0.0, 0.0, 0.0);
    const RigidTransform T_world_source = Mast(0.25, 0.17, 0.05);
    return TwoScans{ScanHummocks(T_world_source), ScanHummocks(T_world_target),
                    T_world_target.inverse() * T_world_source};
  }();
  return scans;
}

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_TESTING_HUMMOCKS_H_
