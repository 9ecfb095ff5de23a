// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/surface_thickness.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace curvereg {
namespace {

// A tilted plane z = x / 10 + 0.06 + noise over 2 m x 2 m.
Scan Plane(double noise_m, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, noise_m);
  Scan scan;
  for (int i = 0; i < 100; ++i) {
    for (int k = 0; k < 100; ++k) {
      const double x = 0.02 * i + 0.007;
      const double y = 0.02 * k + 0.007;
      scan.points.emplace_back(Eigen::Vector3d(x, y, x / 10 + 0.06 + noise(random)).cast<float>());
    }
  }
  return scan;
}

SurfaceThickness::Result TwoScans(double noise_m, double height_error_m) {
  SurfaceThickness thickness(0.25);
  thickness.Add(Plane(noise_m, 1), RigidTransform::Identity());
  thickness.Add(Plane(noise_m, 2), RigidTransform(Eigen::Translation3d(0.0, 0.0, height_error_m)));
  return thickness.Measure();
}

TEST(SurfaceThicknessTest, IsTheNoiseWhereScansAreAlignedRight) {
  EXPECT_NEAR(TwoScans(0.0, 0.0).median_m, 0.0, 1e-4);  // rounding of float32
  EXPECT_NEAR(TwoScans(0.01, 0.0).median_m, 0.01, 0.001);
  EXPECT_GE(TwoScans(0.01, 0.0).num_cells, 64);
}

TEST(SurfaceThicknessTest, GrowsWithTheErrorOfAPose) {
  // Two sheets 2a apart have a standard deviation of a across them, less by the slope's cosine.
  EXPECT_NEAR(TwoScans(0.0, 0.02).median_m, 0.01, 0.0005);
  EXPECT_NEAR(TwoScans(0.01, 0.04).median_m, std::hypot(0.01, 0.02), 0.002);
}

TEST(SurfaceThicknessTest, NeedsTwoScansThatSawThePlace) {
  SurfaceThickness thickness;
  EXPECT_EQ(thickness.Measure().num_cells, 0);
  EXPECT_TRUE(std::isnan(thickness.Measure().median_m));
  thickness.Add(Plane(0.01, 1), RigidTransform::Identity());
  EXPECT_EQ(thickness.Measure().num_cells, 0);
  thickness.Add(Plane(0.01, 2), RigidTransform(Eigen::Translation3d(50.0, 0.0, 0.0)));
  EXPECT_EQ(thickness.Measure().num_cells, 0);
}

TEST(SurfaceThicknessTest, LeavesOutWhatHasNoPlace) {
  SurfaceThickness thickness;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Scan scan;
  scan.points.assign(20, {nan, 0.0F, 1.0F});
  scan.points.resize(40, {1e12F, 0.0F, 1.0F});
  thickness.Add(scan, RigidTransform::Identity());
  thickness.Add(scan, RigidTransform::Identity());
  EXPECT_EQ(thickness.Measure().num_cells, 0);
}

}  // namespace
}  // namespace curvereg
