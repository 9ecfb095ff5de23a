// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/scan/scan.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "tests/testing/vector_state.h"

namespace curvereg {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Scan Grid(int size) {
  Scan scan;
  for (int i = 0; i < size; ++i) {
    for (int j = 0; j < size; ++j) {
      scan.points.emplace_back(0.1F * static_cast<float>(i), 0.1F * static_cast<float>(j), 0.0F);
    }
  }
  return scan;
}

std::string MessageOf(const Scan& scan) { return std::string(ValidateScan(scan).message()); }

TEST(ScanTest, AcceptsAPlaneAndIgnoresMissingReturns) {
  Scan scan = Grid(12);
  scan.points.emplace_back(kNan, 0.0F, 0.0F);
  EXPECT_TRUE(ValidateScan(scan).ok());
}

TEST(ScanTest, NamesWhatIsWrong) {
  EXPECT_EQ(MessageOf(Scan{}), "scan has 0 finite points; at least 100 are needed");
  Scan equal;
  equal.points.assign(200, Eigen::Vector3f(1.0F, 2.0F, 3.0F));
  EXPECT_EQ(MessageOf(equal), "all points of the scan are equal");
  Scan line;
  for (int i = 0; i < 200; ++i) line.points.emplace_back(static_cast<float>(i), 2.0F * static_cast<float>(i), 1.0F);
  EXPECT_EQ(MessageOf(line), "all points of the scan lie on one line");
  Scan far = Grid(12);
  far.points[3].x() = 1e6F;
  EXPECT_EQ(MessageOf(far), "scan has a coordinate beyond 100000 m; is it in metres?");
  Scan missing;
  missing.points.assign(200, Eigen::Vector3f::Constant(kNan));
  EXPECT_EQ(MessageOf(missing), "scan has 0 finite points; at least 100 are needed");
  Scan infinite = Grid(12);
  infinite.points[0].z() = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(ValidateScan(infinite).ok()) << "an infinite return is no return";
  Scan fallen = Grid(12);
  fallen.gravity = Eigen::Vector3d::Zero();
  EXPECT_EQ(MessageOf(fallen), "gravity vector is zero or not finite");
  ScanLimits limits;
  limits.max_points = 100;
  EXPECT_EQ(ValidateScan(Grid(12), limits).message(), "scan has 144 points; at most 100 are allowed");
}

// Finite coordinates whose sum is not: they must be refused, not taken for missing returns.
TEST(ScanTest, RefusesHugeCoordinatesWhoseSumOverflows) {
  Scan scan = Grid(12);
  scan.points[5].setConstant(3e38F);
  EXPECT_EQ(MessageOf(scan), "scan has a coordinate beyond 100000 m; is it in metres?");
}

// A plane that a regular sample of its points would see as a line is still a plane.
TEST(ScanTest, LooksAtAllPointsBeforeItCallsThemALine) {
  Scan scan;
  for (int i = 0; i < 20000; ++i) scan.points.emplace_back(static_cast<float>(i) * 0.01F, 0.0F, 0.0F);
  for (int i = 1; i < 200; ++i)
    scan.points[static_cast<size_t>(i * 7 + 1)].y() = 1.0F + 0.1F * static_cast<float>(i % 5);
  EXPECT_TRUE(ValidateScan(scan).ok());
}

TEST(ScanTest, DigestChangesWithPointsAndGravity) {
  Scan scan = Grid(12);
  const std::string digest = ScanDigest(scan);
  EXPECT_EQ(digest.size(), 16U);
  EXPECT_EQ(ScanDigest(Grid(12)), digest);
  scan.gravity = Eigen::Vector3d(0.0, 0.0, -1.0);
  EXPECT_NE(ScanDigest(scan), digest);
  scan.gravity.reset();
  scan.points[7].z() += 1e-6F;
  EXPECT_NE(ScanDigest(scan), digest);
}

TEST(ScanTest, DigestLeavesTheUpperVectorHalvesUnused) {
  if (!testing::UpperVectorHalvesInUse().has_value()) GTEST_SKIP() << "the processor does not tell";
  static_cast<void>(ScanDigest(Grid(100)));
  EXPECT_FALSE(*testing::UpperVectorHalvesInUse());
}

TEST(ScanTest, TransformMovesPointsAndTurnsGravity) {
  Scan scan = Grid(2);
  scan.gravity = Eigen::Vector3d(0.0, 0.0, -1.0);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX()).toRotationMatrix();
  T.translation() = Eigen::Vector3d(0.0, 0.0, 5.0);
  const Scan moved = TransformScan(scan, T);
  EXPECT_LT((moved.points[1] - Eigen::Vector3f(0.0F, 0.0F, 5.1F)).norm(), 1e-6F);
  EXPECT_LT((*moved.gravity - Eigen::Vector3d(0.0, 1.0, 0.0)).norm(), 1e-12);
}

// Whatever the cuts.
TEST(FinitePointCounterTest, CountsAsTheWhole) {
  Scan scan = Grid(40);
  scan.points[7].y() = std::numeric_limits<float>::quiet_NaN();
  scan.points[9].z() = -std::numeric_limits<float>::infinity();
  for (const size_t i : {size_t{511}, size_t{512}, scan.points.size() - 1}) {
    scan.points[i].x() = std::numeric_limits<float>::infinity();
  }
  const std::string_view bytes(reinterpret_cast<const char*>(scan.points.data()), scan.points.size() * 12);
  for (const std::size_t piece : {std::size_t{1}, std::size_t{5}, std::size_t{12}, std::size_t{1000}, bytes.size()}) {
    FinitePointCounter counter;
    for (std::size_t i = 0; i < bytes.size(); i += piece) counter.Update(bytes.substr(i, piece));
    EXPECT_EQ(counter.count(), static_cast<int64_t>(scan.points.size()) - 5) << piece;
  }
  EXPECT_EQ(FinitePointCounter().count(), 0);
}

}  // namespace
}  // namespace curvereg
