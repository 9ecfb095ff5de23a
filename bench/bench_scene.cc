// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/bench_scene.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace curvereg::bench {
namespace {

// Even on [0, 1), from a place and what is asked about it.
double Hash(int64_t x, int64_t y, int64_t what) {
  auto h = static_cast<uint64_t>(x * 73856093 ^ y * 19349663 ^ what * 83492791);
  h = (h ^ (h >> 31U)) * 0x9E3779B97F4A7C15ULL;
  h = (h ^ (h >> 29U)) * 0xBF58476D1CE4E5B9ULL;
  return static_cast<double>((h ^ (h >> 32U)) >> 11U) * 0x1p-53;
}

// A swell, and in each square of 2.5 m one hump that ends within it.
double Height(double x, double y) {
  constexpr double kSquare = 2.5;
  const auto col = static_cast<int64_t>(std::floor(x / kSquare));
  const auto row = static_cast<int64_t>(std::floor(y / kSquare));
  const double radius = 0.3 + 0.9 * Hash(col, row, 1);
  const double reach = kSquare - 2.0 * radius;
  const double dx = x - (static_cast<double>(col) * kSquare + radius + reach * Hash(col, row, 2));
  const double dy = y - (static_cast<double>(row) * kSquare + radius + reach * Hash(col, row, 3));
  const double inside = std::max(0.0, 1.0 - (dx * dx + dy * dy) / (radius * radius));
  const double hump = 0.5 * radius * (Hash(col, row, 4) - 0.3) * inside * inside * inside;
  return 0.3 * std::sin(0.11 * x) * std::cos(0.09 * y) + hump;
}

// Range at which the beam meets the ground. Precondition: it points down.
double CastBeam(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  constexpr double kSlope = 1.0;  // steepest ground
  double range = 0.0;
  for (;;) {
    const Eigen::Vector3d p = origin + range * direction;
    const double gap = p.z() - Height(p.x(), p.y());
    if (gap < 0.002) return range;
    range += gap / (kSlope - direction.z());
  }
}

}  // namespace

RigidTransform BenchPose(double x, double y, double yaw_rad) {
  RigidTransform T_world_sensor = RigidTransform::Identity();
  T_world_sensor.linear() = RotationFromVector({0.0, 0.0, yaw_rad});
  T_world_sensor.translation() << x, y, Height(x, y) + 1.6;
  return T_world_sensor;
}

std::vector<Eigen::Vector3f> BenchScan(const RigidTransform& T_world_sensor) {
  constexpr int kColumns = 1000, kRows = 224;
  constexpr double kDegree = std::numbers::pi / 180.0;
  const auto seed = static_cast<int64_t>(1e3 * T_world_sensor.translation().x());
  std::vector<Eigen::Vector3f> points;
  for (int column = 0; column < kColumns; ++column) {
    const double azimuth = 2.0 * std::numbers::pi * column / kColumns;
    for (int row = 0; row < kRows; ++row) {
      const double elevation = kDegree * std::lerp(-40.0, -2.0, (row + 0.5) / kRows);
      const Eigen::Vector3d direction(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                      std::sin(elevation));
      const double range = CastBeam(T_world_sensor.translation(), T_world_sensor.linear() * direction);
      const double noise = 0.017 * (Hash(column, row, seed + 5) - 0.5);
      points.emplace_back(((range + noise) * direction).cast<float>());
    }
  }
  return points;
}

ViewFeatures BenchView(const std::vector<Eigen::Vector3f>& points) {
  return *ComputeViewFeatures(points, Eigen::Matrix3d::Identity(), ElevationViewOptions());
}

std::unique_ptr<const PreparedScan> BenchPrepared(const std::vector<Eigen::Vector3f>& points) {
  auto scan = std::make_shared<Scan>();
  scan->points = points;
  return *PreparedScan::Create(std::move(scan));
}

}  // namespace curvereg::bench
