// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/warm_up.h"

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/register_scans.h"

namespace curvereg::server {
namespace {

constexpr double kMaxErrorM = 0.05;
constexpr double kMaxErrorRad = 0.01;
constexpr int kNumAzimuths = 360;
constexpr int kNumRings = 80;

// In [0, 1), without any pattern that a scan could meet (mixing as in SplitMix64).
double NoiseAt(int64_t i, int64_t j) {
  uint64_t bits = static_cast<uint64_t>(i) * 0x9E3779B97F4A7C15U ^ static_cast<uint64_t>(j) * 0xD1B54A32D192ED03U;
  bits = (bits ^ (bits >> 30U)) * 0xBF58476D1CE4E5B9U;
  bits = (bits ^ (bits >> 27U)) * 0x94D049BB133111EBU;
  return static_cast<double>((bits ^ (bits >> 31U)) >> 11U) * 0x1.0p-53;
}

// A bump of its own height and width in every cell of 2.5 m [m].
double GroundHeight(double x, double y) {
  constexpr double kCell = 2.5;
  const auto column = static_cast<int64_t>(std::floor(x / kCell));
  const auto row = static_cast<int64_t>(std::floor(y / kCell));
  double height = 0.0;
  for (int64_t i = column - 1; i <= column + 1; ++i) {
    for (int64_t j = row - 1; j <= row + 1; ++j) {
      const double bump_x = (static_cast<double>(i) + NoiseAt(i, 4 * j)) * kCell;
      const double bump_y = (static_cast<double>(j) + NoiseAt(i, 4 * j + 1)) * kCell;
      const double width = 0.3 + 0.5 * NoiseAt(i, 4 * j + 2);
      const double distance2 = (x - bump_x) * (x - bump_x) + (y - bump_y) * (y - bump_y);
      height += 0.8 * (NoiseAt(i, 4 * j + 3) - 0.3) * std::exp(-0.5 * distance2 / (width * width));
    }
  }
  return height;
}

// Rings of ground points around a sensor on a mast of 1.8 m.
Scan ScanGround(const RigidTransform& T_world_scan) {
  Scan scan;
  for (int ring = 0; ring < kNumRings; ++ring) {
    const double range = 1.5 * std::pow(1.032, ring);
    for (int i = 0; i < kNumAzimuths; ++i) {
      const double azimuth = 2.0 * std::numbers::pi * i / kNumAzimuths;
      Eigen::Vector3d point = T_world_scan * Eigen::Vector3d(range * std::cos(azimuth), range * std::sin(azimuth), 0.0);
      point.z() = GroundHeight(point.x(), point.y());
      scan.points.emplace_back((T_world_scan.inverse() * point).cast<float>());
    }
  }
  return scan;
}

RigidTransform MastPose(double x, double y, double yaw_rad) {
  RigidTransform T_world_scan = RigidTransform::Identity();
  T_world_scan.linear() = RotationFromVector({0.0, 0.0, yaw_rad});
  T_world_scan.translation() = Eigen::Vector3d(x, y, 1.8);
  return T_world_scan;
}

}  // namespace

absl::Status WarmUp() {
  const RigidTransform T_world_target = MastPose(0.0, 0.0, 0.0);
  const RigidTransform T_world_source = MastPose(1.5, 0.8, 0.3);
  const auto result = RegisterScans(ScanGround(T_world_source), ScanGround(T_world_target));
  if (!result.ok()) return absl::InternalError(absl::StrCat("warm-up registration: ", result.status().message()));
  const TransformDifference error = Difference(T_world_target.inverse() * T_world_source,
                                               result->T_target_source.value_or(RigidTransform::Identity()));
  if (!result->verdict.accepted || error.translation_m > kMaxErrorM || error.rotation_rad > kMaxErrorRad) {
    return absl::InternalError(absl::StrCat("warm-up registration is off by ", error.translation_m, " m, ",
                                            error.rotation_rad, " rad, accepted: ", result->verdict.accepted));
  }
  return absl::OkStatus();
}

}  // namespace curvereg::server
