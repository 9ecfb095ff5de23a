// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/scanner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/base/parallel.h"
#include "sim/dome_world.h"
#include "sim/rover.h"
#include "sim/yard_world.h"

namespace curvereg::sim {
namespace {

// A scanner without any error.
ScannerOptions Perfect() {
  ScannerOptions options;
  options.pattern.columns = 180;
  options.pattern.rows = 90;
  options.noise_m = 0.0;
  options.noise_per_m = 0.0;
  options.grazing_cosine = 0.0;
  return options;
}

RigidTransform TiltedPose(const Eigen::Vector3d& position) {
  RigidTransform T_world_sensor = RigidTransform::Identity();
  T_world_sensor.linear() = RotationFromVector({0.1, -0.15, 2.0});
  T_world_sensor.translation() = position;
  return T_world_sensor;
}

// How far a point lies off the nearest of all true surfaces [m]; vertical distance for the ground.
double OffSurface(const World& world, const Eigen::Vector3d& point) {
  double off = std::abs(point.z() - world.ground().HeightAt(point.x(), point.y()));
  if (std::isnan(off)) off = 1e9;
  for (const Rock& rock : world.rocks()) {
    const double level = (rock.to_unit * (point - rock.centre)).norm() - 1.0;
    off = std::min(off, std::abs(level) * rock.half_extent.maxCoeff());
  }
  if (world.shell().has_value()) {
    off = std::min(off, std::abs(point.cwiseQuotient(world.shell()->semi_axes).norm() - 1.0) * 20.0);
  }
  return off;
}

void ExpectOnSurface(const World& world, const RigidTransform& T_world_sensor, const Scan& scan) {
  double worst = 0.0;
  for (const Eigen::Vector3f& point : scan.points) {
    worst = std::max(worst, OffSurface(world, T_world_sensor * point.cast<double>()));
  }
  EXPECT_LT(worst, 1e-4);
}

World Plain() { return World(MakeHeightGrid(200.0, 200.0, 1.0), {}); }

TEST(ScannerTest, NoiseFreePointsLieOnTheWorld) {
  const World yard = MakeYardWorld({.length_m = 60.0, .width_m = 40.0}, 1.0, 2);
  const RigidTransform T_yard = TiltedPose({2.0, -3.0, yard.SurfaceHeight(2.0, -3.0) + 1.8});
  const Scan scan = SimulateScan(yard, T_yard, Perfect(), 1);
  EXPECT_GT(scan.points.size(), 9'000U);
  ExpectOnSurface(yard, T_yard, scan);
  const World dome = MakeDomeWorld({}, 1.0, 2);
  const RigidTransform T_dome = TiltedPose({1.0, 2.0, dome.SurfaceHeight(1.0, 2.0) + 1.8});
  const Scan inside = SimulateScan(dome, T_dome, Perfect(), 1);
  EXPECT_EQ(inside.points.size(), 180U * 90U) << "each beam meets a dome";
  ExpectOnSurface(dome, T_dome, inside);
}

TEST(ScannerTest, SameBytesAtAnyThreadCount) {
  const World yard = MakeYardWorld({.length_m = 60.0, .width_m = 40.0}, 1.0, 2);
  const RigidTransform T = TiltedPose({2.0, -3.0, yard.SurfaceHeight(2.0, -3.0) + 1.8});
  ScannerOptions options;
  options.pattern.columns = 180;
  options.beam_jitter_rad = 0.001;
  options.dropout_fraction = 0.1;
  options.outlier_fraction = 0.1;
  options.mixed_edge_fraction = 0.5;
  options.keep_fraction = 0.7;
  options.motion.forward_mps = 0.05;
  Scan reference;
  WithThreadLimit(1, [&] { reference = SimulateScan(yard, T, options, 5); });
  ASSERT_GT(reference.points.size(), 10'000U);
  for (const int threads : {2, 4}) {
    Scan scan;
    WithThreadLimit(threads, [&] { scan = SimulateScan(yard, T, options, 5); });
    ASSERT_EQ(scan.points.size(), reference.points.size());
    EXPECT_EQ(std::memcmp(scan.points.data(), reference.points.data(), scan.points.size() * 12), 0);
  }
  EXPECT_NE(ScanDigest(SimulateScan(yard, T, options, 6)), ScanDigest(reference)) << "another key, another scan";
}

TEST(ScannerTest, NoiseHasItsDeviation) {
  const World plain = Plain();
  const RigidTransform T = TiltedPose({0.0, 0.0, 2.0});
  ScannerOptions options = Perfect();
  options.max_range_m = 1000.0;
  const Scan truth = SimulateScan(plain, T, options, 1);
  options.noise_m = 0.01;
  options.noise_per_m = 0.001;
  const Scan noisy = SimulateScan(plain, T, options, 1);
  ASSERT_EQ(noisy.points.size(), truth.points.size());
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < truth.points.size(); ++i) {
    const double range = static_cast<double>(truth.points[i].norm());
    const double error = (static_cast<double>(noisy.points[i].norm()) - range) / (0.01 + 0.001 * range);
    sum += error;
    squares += error * error;
    EXPECT_LT(noisy.points[i].cross(truth.points[i]).norm(), 1e-5F * truth.points[i].squaredNorm()) << "along the beam";
  }
  const auto count = static_cast<double>(truth.points.size());
  EXPECT_NEAR(sum / count, 0.0, 0.04);
  EXPECT_NEAR(squares / count, 1.0, 0.05);
}

TEST(ScannerTest, ThinningAndDropoutHaveTheirShares) {
  const World dome = MakeDomeWorld({}, 1.0, 2);
  const RigidTransform T = TiltedPose({1.0, 2.0, dome.SurfaceHeight(1.0, 2.0) + 1.8});
  ScannerOptions options = Perfect();
  const auto all = static_cast<double>(options.pattern.num_beams());
  options.keep_fraction = 0.25;
  EXPECT_NEAR(static_cast<double>(SimulateScan(dome, T, options, 1).points.size()) / all, 0.25, 0.012);
  options.dropout_fraction = 0.2;
  EXPECT_NEAR(static_cast<double>(SimulateScan(dome, T, options, 1).points.size()) / all, 0.2, 0.012);
}

TEST(ScannerTest, OutliersHaveTheirShareAndStayOnTheBeam) {
  const World dome = MakeDomeWorld({}, 1.0, 2);
  const RigidTransform T = TiltedPose({1.0, 2.0, dome.SurfaceHeight(1.0, 2.0) + 1.8});
  ScannerOptions options = Perfect();
  const Scan truth = SimulateScan(dome, T, options, 1);
  options.outlier_fraction = 0.15;
  const Scan scan = SimulateScan(dome, T, options, 1);
  ASSERT_EQ(scan.points.size(), truth.points.size());
  int num_outliers = 0;
  int num_beyond = 0;
  for (std::size_t i = 0; i < truth.points.size(); ++i) {
    const float range = truth.points[i].norm();
    const float measured = scan.points[i].norm();
    if (std::abs(measured - range) < 1e-4F) continue;
    ++num_outliers;
    if (measured > range) ++num_beyond;
    EXPECT_GE(measured, 0.5F - 1e-5F);
    EXPECT_LE(measured, 1.5F * range + 1e-4F);
  }
  EXPECT_NEAR(num_outliers / static_cast<double>(truth.points.size()), 0.15, 0.012);
  EXPECT_NEAR(num_beyond / static_cast<double>(num_outliers), 0.35, 0.05);
}

TEST(ScannerTest, GrazingBeamsAreLostNearOnesAreNot) {
  const World plain = Plain();
  RigidTransform T = RigidTransform::Identity();
  T.translation().z() = 2.0;
  ScannerOptions options = Perfect();
  const Scan truth = SimulateScan(plain, T, options, 1);
  options.grazing_cosine = 0.1;  // 20 m from a mast of 2 m
  const Scan scan = SimulateScan(plain, T, options, 1);
  const auto count_between = [](const Scan& points, float low, float high) {
    return std::count_if(points.points.begin(), points.points.end(),
                         [&](const Eigen::Vector3f& point) { return point.norm() >= low && point.norm() < high; });
  };
  EXPECT_EQ(count_between(scan, 0.0F, 19.9F), count_between(truth, 0.0F, 19.9F));
  const auto far = static_cast<double>(count_between(truth, 20.1F, 80.0F));
  const auto far_left = static_cast<double>(count_between(scan, 20.1F, 80.0F));
  EXPECT_GT(far, 0.0);
  EXPECT_LT(far_left, 0.8 * far);
  EXPECT_GT(far_left, 0.2 * far);
}

TEST(ScannerTest, RangeLimits) {
  const World dome = MakeDomeWorld({}, 1.0, 2);
  const RigidTransform T = TiltedPose({1.0, 2.0, dome.SurfaceHeight(1.0, 2.0) + 1.8});
  ScannerOptions options;
  options.pattern.columns = 180;
  options.min_range_m = 5.0;
  options.max_range_m = 12.0;
  const Scan scan = SimulateScan(dome, T, options, 1);
  ASSERT_GT(scan.points.size(), 1000U);
  for (const Eigen::Vector3f& point : scan.points) {
    EXPECT_GE(point.norm(), 5.0F - 1e-5F);
    EXPECT_LE(point.norm(), 12.0F + 1e-5F);
  }
}

TEST(ScannerTest, MixedEdgesLieBetweenTwoSurfaces) {
  // A ball before a far ground: only at its rim may ranges change.
  Rock ball;
  ball.centre = {5.0, 0.0, 1.0};
  const World world(MakeHeightGrid(200.0, 200.0, 1.0), {ball});
  RigidTransform T = RigidTransform::Identity();
  T.translation().z() = 1.0;
  ScannerOptions options = Perfect();
  options.pattern = {.columns = 7200, .rows = 60, .elevation_min_rad = -0.25, .elevation_max_rad = -0.02};
  const Scan truth = SimulateScan(world, T, options, 1);
  options.mixed_edge_fraction = 1.0;
  const Scan mixed = SimulateScan(world, T, options, 1);
  ASSERT_EQ(mixed.points.size(), truth.points.size());
  int num_on_ball = 0;
  int num_between = 0;
  for (std::size_t i = 0; i < truth.points.size(); ++i) {
    const Eigen::Vector3d point = T * truth.points[i].cast<double>();
    if (std::abs((point - ball.centre).norm() - 1.0) > 1e-3) continue;
    ++num_on_ball;
    if (std::abs(mixed.points[i].norm() - truth.points[i].norm()) > 0.1F) ++num_between;
  }
  EXPECT_GT(num_on_ball, 1000);
  EXPECT_GT(num_between, 10);
  EXPECT_LT(num_between, num_on_ball / 5);
}

TEST(ScannerTest, MotionIsOffUntilAskedForThenEndsAhead) {
  const World plain = Plain();
  RigidTransform T = RigidTransform::Identity();
  T.translation().z() = 2.0;
  ScannerOptions options = Perfect();
  options.pattern = {.columns = 100, .rows = 1, .elevation_min_rad = -0.5, .elevation_max_rad = -0.5};
  options.motion = {.duration_s = 10.0, .forward_mps = 0.1, .yaw_rate_radps = 0.0};
  // A ramp of 0.1 along x: driving ahead brings the ground nearer.
  HeightGrid ramp = MakeHeightGrid(100.0, 100.0, 1.0);
  for (int row = 0; row < ramp.heights.rows; ++row) {
    for (int col = 0; col < ramp.heights.cols; ++col) {
      ramp.heights(row, col) = 0.1F * static_cast<float>(ramp.x_min + col);
    }
  }
  const World slope(ramp, {});
  const Scan moved = SimulateScan(slope, T, options, 1);
  options.motion.forward_mps = 0.0;
  const Scan still = SimulateScan(slope, T, options, 1);
  ASSERT_EQ(moved.points.size(), 100U);
  EXPECT_EQ(moved.points[0], still.points[0]) << "the pose is that of the first beam";
  // The last beam starts 0.99 m ahead, where the ground is 0.099 m nearer to the level sensor.
  const Eigen::Vector3d beam = still.points[99].cast<double>().normalized();
  const double expected = (2.0 - 0.099) / (0.1 * beam.x() - beam.z());
  EXPECT_NEAR(static_cast<double>(moved.points[99].norm()), expected, 1e-4);
}

}  // namespace
}  // namespace curvereg::sim
