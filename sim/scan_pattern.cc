// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/scan_pattern.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace curvereg::sim {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

Eigen::Vector3d FromAngles(double azimuth, double elevation) {
  const double horizontal = std::cos(elevation);
  return {horizontal * std::cos(azimuth), horizontal * std::sin(azimuth), std::sin(elevation)};
}

Eigen::Vector3d RosetteDirection(const ScanPattern& pattern, int index) {
  // Two prisms of equal strength: the tip is the sum of two circles of half the radius. Their speeds are
  // incommensurable, so the petals drift and the cone fills up.
  const double time = static_cast<double>(index) / pattern.columns;
  const double first = kTurn * 0.5 * (1.0 + std::numbers::phi / 100.0) * time;
  const double second = -kTurn * 0.5 * (1.0 - std::numbers::phi / 130.0) * time;
  const double radius = 0.5 * pattern.rosette_half_angle_rad;
  const double right = radius * (std::cos(first) + std::cos(second));
  const double up = radius * (std::sin(first) + std::sin(second));
  const double angle = std::hypot(right, up);
  const double sine_over_angle = angle > 1e-9 ? std::sin(angle) / angle : 1.0;
  const Eigen::Vector3d about_x(std::cos(angle), -right * sine_over_angle, up * sine_over_angle);
  const double cosine = std::cos(pattern.rosette_elevation_rad);
  const double sine = std::sin(pattern.rosette_elevation_rad);
  return {cosine * about_x.x() - sine * about_x.z(), about_x.y(), sine * about_x.x() + cosine * about_x.z()};
}

}  // namespace

Eigen::Vector3d BeamDirection(const ScanPattern& pattern, int index) {
  const double field = pattern.elevation_max_rad - pattern.elevation_min_rad;
  switch (pattern.kind) {
    case PatternKind::kRegular: {
      const int column = index / pattern.rows;
      const int row = index % pattern.rows;
      return FromAngles(kTurn * column / pattern.columns,
                        pattern.elevation_min_rad + field * row / std::max(1, pattern.rows - 1));
    }
    case PatternKind::kSpiral:
      return FromAngles(kTurn * (index % pattern.columns) / pattern.columns,
                        pattern.elevation_min_rad + field * index / std::max(1, pattern.num_beams() - 1));
    case PatternKind::kRosette:
      return RosetteDirection(pattern, index);
  }
  return Eigen::Vector3d::UnitX();
}

}  // namespace curvereg::sim
