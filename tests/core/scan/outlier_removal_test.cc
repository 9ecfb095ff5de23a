// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/scan/outlier_removal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/testing/same_bytes.h"
#include "tests/testing/scenes.h"

namespace curvereg {
namespace {

using Points = std::vector<Eigen::Vector3f>;

const Eigen::Vector3d kUp = Eigen::Vector3d::UnitZ();

const Points& Ground() {
  static const Points points = testing::BumpyGround(testing::RoverPose(0.0, 0.0, 0.0)).points;
  return points;
}

// False returns: anywhere along random beams that go down to the ground.
Points FalseReturns(int count) {
  testing::Random random(9);
  Points points;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d direction(random.Gaussian(), random.Gaussian(), random.Uniform(-0.3, 0.0));
    points.emplace_back((random.Uniform(0.5, 3.0) * direction.normalized()).cast<float>());
  }
  return points;
}

TEST(RemoveOutliersTest, KeepsTheGroundAndDropsFalseReturns) {
  const Points false_returns = FalseReturns(300);
  Points points = Ground();
  points.insert(points.begin() + 1000, false_returns.begin(), false_returns.end());
  const Points kept = RemoveOutliers(points, kUp);
  int num_false = 0;
  for (const Eigen::Vector3f& point : false_returns) {
    num_false += static_cast<int>(std::find(kept.begin(), kept.end(), point) != kept.end());
  }
  EXPECT_LT(num_false, 60);
  EXPECT_GT(static_cast<double>(kept.size()), 0.9 * static_cast<double>(Ground().size()));
}

TEST(RemoveOutliersTest, KeepsTheOrderAndChangesNoPoint) {
  const Points kept = RemoveOutliers(Ground(), kUp);
  auto at = Ground().begin();
  for (const Eigen::Vector3f& point : kept) {
    at = std::find(at, Ground().end(), point);
    ASSERT_NE(at, Ground().end());
    ++at;
  }
}

TEST(RemoveOutliersTest, AReturnNeedsTwoThatAgree) {
  const Points pair = {{10.0F, 0.1F, 0.0F}, {10.1F, 0.1F, 0.0F}};
  EXPECT_TRUE(RemoveOutliers(pair, kUp).empty());
  Points three = pair;
  three.push_back({10.2F, 0.1F, 0.0F});
  EXPECT_EQ(RemoveOutliers(three, kUp).size(), 3U);
  EXPECT_EQ(RemoveOutliers(pair, kUp, {.min_agreeing = 1}).size(), 2U);
  three.back() = {20.0F, 0.2F, 0.0F};  // the same direction, but another range
  EXPECT_TRUE(RemoveOutliers(three, kUp).empty());
}

TEST(RemoveOutliersTest, HeightIsAlongTheVerticalGiven) {
  // Three returns of one direction and range but heights along y that differ by half a metre.
  const Points points = {{10.0F, 0.0F, 0.0F}, {10.0F, 0.5F, 0.0F}, {10.0F, -0.5F, 0.0F}};
  const OutlierRemovalOptions coarse{.bins_per_side = 5};
  EXPECT_EQ(RemoveOutliers(points, kUp, coarse).size(), 3U);
  EXPECT_TRUE(RemoveOutliers(points, Eigen::Vector3d::UnitY(), coarse).empty());
}

TEST(RemoveOutliersTest, DropsWhatIsNotFinite) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Points points(10, {10.0F, 0.1F, 0.0F});
  points[3] = {kNan, 0.0F, 1.0F};
  points[7] = {0.0F, -kInfinity, 1.0F};
  EXPECT_EQ(RemoveOutliers(points, kUp).size(), 8U);
  EXPECT_TRUE(RemoveOutliers(Points(5, {kNan, kNan, kNan}), kUp).empty());
  EXPECT_TRUE(RemoveOutliers({}, kUp).empty());
  EXPECT_TRUE(RemoveOutliers({{1.0F, 2.0F, 3.0F}}, kUp).empty());
}

TEST(RemoveOutliersTest, SameBytesAtAnyThreadCount) {
  testing::ExpectSameBytesAtAnyThreadCount([&](testing::ByteLog& log) {
    for (const Eigen::Vector3f& point : RemoveOutliers(Ground(), kUp)) log.Add(point.data(), 3);
  });
}

}  // namespace
}  // namespace curvereg
