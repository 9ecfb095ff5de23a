// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/scan_pattern.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

namespace curvereg::sim {
namespace {

TEST(ScanPatternTest, RegularGrid) {
  const ScanPattern pattern = {.columns = 8, .rows = 3, .elevation_min_rad = -0.4, .elevation_max_rad = 0.2};
  ASSERT_EQ(pattern.num_beams(), 24);
  for (int i = 0; i < 24; ++i) {
    const Eigen::Vector3d beam = BeamDirection(pattern, i);
    EXPECT_NEAR(beam.norm(), 1.0, 1e-12);
    EXPECT_NEAR(std::asin(beam.z()), -0.4 + 0.3 * (i % 3), 1e-12);
  }
  EXPECT_LT((BeamDirection(pattern, 6 + 1).normalized() - Eigen::Vector3d(0.0, std::cos(-0.1), std::sin(-0.1))).norm(),
            1e-12);
}

// Share of the cells of 10 x 5 degrees in the field that at least one beam visits.
double Coverage(const ScanPattern& pattern) {
  std::set<std::pair<int, int>> cells;
  const double field = pattern.elevation_max_rad - pattern.elevation_min_rad;
  for (int i = 0; i < pattern.num_beams(); ++i) {
    const Eigen::Vector3d beam = BeamDirection(pattern, i);
    const double azimuth = std::atan2(beam.y(), beam.x()) / (2.0 * std::numbers::pi) + 0.5;
    const double height = (std::asin(beam.z()) - pattern.elevation_min_rad) / field;
    EXPECT_GE(height, -1e-9);
    EXPECT_LE(height, 1.0 + 1e-9);
    cells.emplace(std::min(35, static_cast<int>(36.0 * azimuth)), std::min(8, static_cast<int>(9.0 * height)));
  }
  return static_cast<double>(cells.size()) / (36.0 * 9.0);
}

TEST(ScanPatternTest, RegularAndSpiralCoverTheirField) {
  ScanPattern pattern = {.columns = 72, .rows = 36};
  EXPECT_EQ(Coverage(pattern), 1.0);
  pattern.kind = PatternKind::kSpiral;
  EXPECT_EQ(Coverage(pattern), 1.0);
}

TEST(ScanPatternTest, SpiralNeverJumps) {
  const ScanPattern pattern = {.kind = PatternKind::kSpiral, .columns = 180, .rows = 20};
  for (int i = 1; i < pattern.num_beams(); ++i) {
    EXPECT_LT((BeamDirection(pattern, i) - BeamDirection(pattern, i - 1)).norm(), 0.04);
  }
}

TEST(ScanPatternTest, RosetteFillsItsCone) {
  const ScanPattern pattern = {.kind = PatternKind::kRosette, .columns = 720, .rows = 100};
  const Eigen::Vector3d axis(std::cos(pattern.rosette_elevation_rad), 0.0, std::sin(pattern.rosette_elevation_rad));
  std::set<std::pair<int, int>> cells;
  double widest = 0.0;
  for (int i = 0; i < pattern.num_beams(); ++i) {
    const Eigen::Vector3d beam = BeamDirection(pattern, i);
    EXPECT_NEAR(beam.norm(), 1.0, 1e-12);
    const double angle = std::acos(std::min(1.0, beam.dot(axis)));
    widest = std::max(widest, angle);
    const Eigen::Vector3d up = Eigen::Vector3d::UnitY().cross(axis);
    const double turn = std::atan2(beam.dot(up), beam.y()) / (2.0 * std::numbers::pi) + 0.5;
    cells.emplace(std::min(23, static_cast<int>(24.0 * turn)),
                  std::min(3, static_cast<int>(4.0 * angle / pattern.rosette_half_angle_rad)));
  }
  EXPECT_NEAR(widest, pattern.rosette_half_angle_rad, 1e-3);
  EXPECT_EQ(cells.size(), 24U * 4U);
}

}  // namespace
}  // namespace curvereg::sim
