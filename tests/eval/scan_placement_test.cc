// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/scan_placement.h"

#include <vector>

#include <gtest/gtest.h>

namespace curvereg {
namespace {

RigidTransform Pose(double yaw, double x, double y) {
  return Eigen::Translation3d(x, y, 0.5) * Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ());
}

// Edges that agree with `poses`.
RelativePose Edge(const std::vector<RigidTransform>& poses, int source, int target) {
  return {source, target, poses[static_cast<std::size_t>(target)].inverse() * poses[static_cast<std::size_t>(source)]};
}

class ScanPlacementTest : public ::testing::Test {
 protected:
  ScanPlacement Place(std::vector<RelativePose> edges, std::vector<std::optional<RigidTransform>> anchors) const {
    return PlaceScans(static_cast<int>(poses_.size()), edges, anchors);
  }
  void ExpectAt(const std::optional<RigidTransform>& T, const RigidTransform& expected) const {
    ASSERT_TRUE(T.has_value());
    EXPECT_TRUE(T->isApprox(expected, 1e-12));
  }
  std::vector<RigidTransform> poses_ = {Pose(0.3, 0, 0), Pose(1.3, 5, 1), Pose(-2.0, 9, 4), Pose(3.0, 14, 6)};
};

TEST_F(ScanPlacementTest, ChainsRecoverThePosesInEitherDirection) {
  const ScanPlacement placement =
      Place({Edge(poses_, 1, 0), Edge(poses_, 1, 2), Edge(poses_, 3, 2)}, {poses_[0], {}, {}, {}});
  for (std::size_t i = 0; i < 4; ++i) ExpectAt(placement.T_world_scan[i], poses_[i]);
  EXPECT_EQ(placement.parent, (std::vector<int>{-1, 0, 1, 2}));
}

TEST_F(ScanPlacementTest, EachGroupStandsAtItsOwnAnchor) {
  const ScanPlacement placement =
      Place({Edge(poses_, 2, 0), Edge(poses_, 3, 1)}, {poses_[0], poses_[1], Pose(0, 99, 99), Pose(0, 99, 99)});
  for (std::size_t i = 0; i < 4; ++i) ExpectAt(placement.T_world_scan[i], poses_[i]);
}

TEST_F(ScanPlacementTest, WithoutAnchorsTheFirstGroupStandsAtTheIdentity) {
  const ScanPlacement placement = Place({Edge(poses_, 1, 0), Edge(poses_, 3, 2)}, {});
  ExpectAt(placement.T_world_scan[0], RigidTransform::Identity());
  ExpectAt(placement.T_world_scan[1], poses_[0].inverse() * poses_[1]);
  EXPECT_FALSE(placement.T_world_scan[2].has_value());
  EXPECT_FALSE(placement.T_world_scan[3].has_value());
}

TEST_F(ScanPlacementTest, ScansWithoutEdgesStayUnplaced) {
  const ScanPlacement placement = Place({Edge(poses_, 1, 0)}, {poses_[0], {}, poses_[2], {}});
  EXPECT_FALSE(placement.T_world_scan[2].has_value());
  const ScanPlacement none = PlaceScans(0, {}, {});
  EXPECT_TRUE(none.T_world_scan.empty());
}

TEST_F(ScanPlacementTest, AnAnchorAnywhereInTheGroupIsUsed) {
  const ScanPlacement placement = Place({Edge(poses_, 1, 0), Edge(poses_, 2, 1)}, {{}, {}, poses_[2], {}});
  ExpectAt(placement.T_world_scan[0], poses_[0]);
}

}  // namespace
}  // namespace curvereg
