// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What the scans leave undetermined is called degenerate, not invented.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>

#include "core/register_scans.h"
#include "tests/testing/matchers.h"
#include "tests/testing/scenes.h"
#include "tests/testing/simulated.h"

namespace curvereg {
namespace {

using ::testing::Contains;
using testing::IsOk;
using testing::ScanPairWithTruth;

// How much of the unit vector of (rotation, translation) lies in the span of the degenerate directions, [0, 1].
double ShareInSpan(const std::vector<DegenerateDirection>& directions, const Vector6d& unit) {
  if (directions.empty()) return 0.0;
  Eigen::MatrixXd basis(6, directions.size());
  for (size_t i = 0; i < directions.size(); ++i) basis.col(static_cast<Eigen::Index>(i)) = directions[i].direction;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(basis);
  const Eigen::MatrixXd q = Eigen::MatrixXd(qr.householderQ()).leftCols(qr.rank());
  return (q.transpose() * unit).norm();
}

Vector6d Turn(const Eigen::Vector3d& axis) {
  Vector6d direction = Vector6d::Zero();
  direction.head<3>() = axis.normalized();
  return direction;
}

Vector6d Shift(const Eigen::Vector3d& axis) {
  Vector6d direction = Vector6d::Zero();
  direction.tail<3>() = axis.normalized();
  return direction;
}

std::string Text(const std::vector<DegenerateDirection>& directions) {
  std::ostringstream text;
  for (const DegenerateDirection& d : directions) text << d.direction.transpose() << " sigma " << d.sigma << "; ";
  return text.str();
}

constexpr double kInSpan = 0.98;
constexpr double kOutOfSpan = 0.3;

// The rover's mast, leaning a little, on a plain at z = 0.
RigidTransform PoseOnPlain(double x, double y, double yaw_rad, const Eigen::Vector3d& lean = {0.02, -0.03, 0.0}) {
  RigidTransform T_world_sensor = testing::UprightPose(x, y, yaw_rad, 1.8);
  T_world_sensor.rotate(RotationFromVector(lean));
  return T_world_sensor;
}

// A scan of a plain. Gravel so fine that each beam meets a stone of its own lifts each return by its own height.
Scan ScanPlain(const RigidTransform& T_world_sensor, double gravel_m, uint64_t key) {
  static const sim::World world(sim::MakeHeightGrid(160.0, 160.0, 1.0), {});
  Scan scan = sim::SimulateScan(world, T_world_sensor, {}, key);
  const Eigen::Vector3d up = T_world_sensor.linear().transpose().col(2);
  testing::Random random(key);
  for (Eigen::Vector3f& point : scan.points) point += (gravel_m * random.Gaussian() * up).cast<float>();
  return scan;
}

void ExpectPlainIsDegenerate(const Scan& source, const Scan& target, const RigidTransform& T_world_target) {
  const auto result = RegisterScans(source, target);
  ASSERT_THAT(result, IsOk());
  EXPECT_FALSE(result->verdict.accepted);
  EXPECT_THAT(result->verdict.reasons, Contains(Reason::kDegenerateDirection));
  const Eigen::Matrix3d R_target_world = T_world_target.linear().transpose();
  const std::vector<DegenerateDirection>& found = result->degenerate_directions;
  SCOPED_TRACE(Text(found));
  EXPECT_GT(ShareInSpan(found, Shift(R_target_world.col(0))), kInSpan) << "x";
  EXPECT_GT(ShareInSpan(found, Shift(R_target_world.col(1))), kInSpan) << "y";
  EXPECT_GT(ShareInSpan(found, Turn(R_target_world.col(2))), kInSpan) << "yaw";
  EXPECT_LT(ShareInSpan(found, Shift(R_target_world.col(2))), kOutOfSpan) << "height is determined";
  EXPECT_LT(ShareInSpan(found, Turn(R_target_world.col(0))), kOutOfSpan) << "roll is determined";
  EXPECT_LT(ShareInSpan(found, Turn(R_target_world.col(1))), kOutOfSpan) << "pitch is determined";
}

class PlainTest : public ::testing::TestWithParam<double> {};

TEST_P(PlainTest, PlaceAndHeadingAreDegenerate) {
  const RigidTransform T_world_target = PoseOnPlain(0.0, 0.0, 0.0);
  const Scan target = ScanPlain(T_world_target, GetParam(), 1);
  ASSERT_GT(target.points.size(), 100'000U);
  uint64_t key = 2;
  for (const auto& [x, y, yaw] : {std::array{5.0, 1.0, 0.1}, {0.5, -0.2, 0.02}, {-12.0, 6.0, 2.5}, {0.0, 0.0, 0.0}}) {
    SCOPED_TRACE(::testing::Message() << "moved to " << x << ", " << y << ", yaw " << yaw);
    const RigidTransform T_world_source = PoseOnPlain(x, y, yaw, {-0.03, 0.01, 0.0});
    ExpectPlainIsDegenerate(ScanPlain(T_world_source, GetParam(), key++), target, T_world_target);
  }
}

INSTANTIATE_TEST_SUITE_P(Gravel, PlainTest, ::testing::Values(0.0, 0.005, 0.02),
                         [](const auto& gravel) { return std::to_string(std::lround(1000.0 * gravel.param)) + "mm"; });

// Two walls and a floor without end, along the world's x.
Scan Corridor(const RigidTransform& T_world_sensor, uint64_t seed) {
  constexpr double kHalfWidth = 2.5;
  constexpr double kWallHeight = 3.0;
  constexpr double kMaxRange = 40.0;
  testing::Random random(seed);
  Scan scan;
  for (int column = 0; column < 1440; ++column) {
    for (int row = 0; row < 96; ++row) {
      const double azimuth = 2.0 * std::numbers::pi * column / 1440.0;
      const double elevation = -0.6 + 0.9 * (row + 0.5) / 96.0;
      const Eigen::Vector3d beam(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                 std::sin(elevation));
      const Eigen::Vector3d d = T_world_sensor.linear() * beam;
      const Eigen::Vector3d o = T_world_sensor.translation();
      const double to_wall = ((d.y() > 0.0 ? kHalfWidth : -kHalfWidth) - o.y()) / d.y();
      const double to_floor = d.z() < 0.0 ? -o.z() / d.z() : kMaxRange;
      const double range = std::min(to_wall, to_floor);
      if (!(range < kMaxRange) || o.z() + range * d.z() > kWallHeight) continue;
      scan.points.push_back(((range + 0.005 * random.Gaussian()) * beam).cast<float>());
    }
  }
  return scan;
}

TEST(CorridorTest, TheWayAlongIsDegenerate) {
  const RigidTransform T_world_target = PoseOnPlain(0.0, 0.3, 0.4);
  const Scan target = Corridor(T_world_target, 1);
  for (const double x : {0.0, 0.5, 3.0}) {
    SCOPED_TRACE(x);
    const auto result = RegisterScans(Corridor(PoseOnPlain(x, -0.4, 0.1, {0.0, 0.02, 0.0}), 2), target);
    ASSERT_THAT(result, IsOk());
    EXPECT_FALSE(result->verdict.accepted);
    EXPECT_THAT(result->verdict.reasons, Contains(Reason::kDegenerateDirection));
    const Eigen::Matrix3d R_target_world = T_world_target.linear().transpose();
    const std::vector<DegenerateDirection>& found = result->degenerate_directions;
    SCOPED_TRACE(Text(found));
    EXPECT_EQ(found.size(), 1U);
    EXPECT_GT(ShareInSpan(found, Shift(R_target_world.col(0))), kInSpan);
    EXPECT_LT(ShareInSpan(found, Shift(R_target_world.col(1))), kOutOfSpan);
    EXPECT_LT(ShareInSpan(found, Shift(R_target_world.col(2))), kOutOfSpan);
    EXPECT_LT(ShareInSpan(found, Turn(R_target_world.col(2))), kOutOfSpan);
  }
}

TEST(YardTest, NothingIsDegenerate) {
  for (const auto& [preset, every] :
       {std::pair("mars-yard-sim", 1), {"mars-yard-sim", 4}, {"flat", 2}, {"mars-dome", 5}}) {
    SCOPED_TRACE(preset);
    const ScanPairWithTruth pair = testing::PairOf(preset, every + 3, 3);
    const auto result = RegisterScans(pair.source, pair.target);
    ASSERT_THAT(result, IsOk());
    EXPECT_TRUE(result->verdict.accepted);
    EXPECT_TRUE(result->degenerate_directions.empty()) << Text(result->degenerate_directions);
    ASSERT_TRUE(result->covariance.has_value());
    // Every direction is known to a few centimetres and milliradians.
    EXPECT_LT(result->covariance->diagonal().head<3>().maxCoeff(), 0.005 * 0.005);
    EXPECT_LT(result->covariance->diagonal().tail<3>().maxCoeff(), 0.05 * 0.05);
  }
}

}  // namespace
}  // namespace curvereg
