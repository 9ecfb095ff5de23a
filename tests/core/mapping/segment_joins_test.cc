// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/segment_joins.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/testing/matchers.h"

namespace curvereg {
namespace {

using testing::IsNear;

RigidTransform At(double x, double yaw_rad) {
  RigidTransform T = RigidTransform::Identity();
  T.linear() = RotationFromVector({0.0, 0.0, yaw_rad});
  T.translation() = Eigen::Vector3d(x, 0.5 * x, 0.1);
  return T;
}

// Poses 0..2 of segment 0, 3..5 of segment 1, 6..8 of segment 2; T_world_segment of each.
const std::vector<RigidTransform> kTrueFrames = {At(0.0, 0.0), At(20.0, 0.7), At(-15.0, -1.1)};

Traverse ThreeSegments() {
  Traverse traverse;
  for (uint64_t number = 0; number < 9; ++number) {
    TrajectoryPose pose;
    pose.sequence_number = number;
    pose.segment = static_cast<int>(number / 3);
    pose.T_segment_scan = At(5.0 * static_cast<double>(number % 3), 0.1);
    traverse.poses.push_back(pose);
  }
  return traverse;
}

RigidTransform TrueWorldScan(const Traverse& traverse, uint64_t number) {
  const TrajectoryPose& pose = traverse.poses[number];
  return kTrueFrames[static_cast<size_t>(pose.segment)] * pose.T_segment_scan;
}

void Link(Traverse& traverse, uint64_t source, uint64_t target, double error_m = 0.0, bool accepted = true) {
  TraverseLink link;
  link.source = source;
  link.target = target;
  link.result.T_target_source = TrueWorldScan(traverse, target).inverse() * TrueWorldScan(traverse, source);
  link.result.T_target_source->translation().x() += error_m;
  link.result.verdict.accepted = accepted;
  traverse.links.push_back(link);
}

TEST(PlaceSegmentsTest, WithoutLinksEachStaysItsOwn) {
  Traverse traverse = ThreeSegments();
  Link(traverse, 4, 1, 0.0, false);  // rejected
  Link(traverse, 5, 4);              // within a segment
  const SegmentPlaces places = PlaceSegments(traverse, {});
  for (const auto& [segment, place] : places) EXPECT_EQ(place.root, segment);
  EXPECT_EQ(places.size(), 3U);
  EXPECT_TRUE(PlaceSegments(Traverse{}, {}).empty());
}

TEST(PlaceSegmentsTest, ChainsOfSegmentsMeetInTheLowest) {
  Traverse traverse = ThreeSegments();
  Link(traverse, 7, 4);  // 2 with 1 first
  Link(traverse, 3, 2);  // then 1 with 0
  const SegmentPlaces places = PlaceSegments(traverse, {});
  for (const int segment : {0, 1, 2}) {
    EXPECT_EQ(places.at(segment).root, 0);
    EXPECT_THAT(places.at(segment).T_root_segment,
                IsNear(kTrueFrames[0].inverse() * kTrueFrames[static_cast<size_t>(segment)], 1e-9, 1e-9));
  }
  EXPECT_FALSE(SameJoins(places, PlaceSegments(traverse, {1})));
  EXPECT_EQ(PlaceSegments(traverse, {1}).at(2).root, 1);
}

TEST(PlaceSegmentsTest, WhatMostLinksSayCounts) {
  Traverse traverse = ThreeSegments();
  Link(traverse, 3, 0, 30.0);
  Link(traverse, 4, 1, 0.02);
  Link(traverse, 5, 2, -0.02);
  const SegmentPlaces places = PlaceSegments(traverse, {});
  EXPECT_THAT(places.at(1).T_root_segment, IsNear(kTrueFrames[0].inverse() * kTrueFrames[1], 0.05, 0.01));
  EXPECT_EQ(places.at(2).root, 2);
}

// Links that are off by a few milliradians say metres of difference at an origin 500 m away, but agree where they are.
TEST(PlaceSegmentsTest, LinksFarFromTheOriginAgreeWhereTheyAre) {
  Traverse traverse = ThreeSegments();
  for (uint64_t number = 3; number < 6; ++number) traverse.poses[number].T_segment_scan.translation().x() += 500.0;
  Link(traverse, 3, 0, 30.0);  // wrong, and the first
  Link(traverse, 4, 1);
  Link(traverse, 5, 2);
  for (const size_t i : {1, 2}) {
    RigidTransform& T = *traverse.links[i].result.T_target_source;
    T.linear() = RotationFromVector({0.0, 0.0, i == 1 ? 0.005 : -0.005}) * T.linear();
  }
  const RigidTransform T_root_segment = PlaceSegments(traverse, {}).at(1).T_root_segment;
  const RigidTransform T_true = kTrueFrames[0].inverse() * kTrueFrames[1];
  const Eigen::Vector3d place = traverse.poses[4].T_segment_scan.translation();
  EXPECT_LT((T_root_segment * place - T_true * place).norm(), 0.1);
  EXPECT_LT(Difference(T_root_segment, T_true).rotation_rad, 0.006);
}

// Turned about the segment's origin, links agree there and nowhere else.
TEST(PlaceSegmentsTest, LinksThatAgreeAtTheOriginAloneDoNot) {
  Traverse traverse = ThreeSegments();
  for (uint64_t number = 3; number < 6; ++number) traverse.poses[number].T_segment_scan.translation().x() += 500.0;
  Link(traverse, 3, 0);
  Link(traverse, 4, 1);
  Link(traverse, 5, 2);
  const RigidTransform T_true = kTrueFrames[0].inverse() * kTrueFrames[1];
  for (const size_t i : {0, 2}) {  // 15 m off at the scans to either side, nothing at the origin
    const TraverseLink& link = traverse.links[i];
    RigidTransform T_wrong = T_true;
    T_wrong.linear() = T_true.linear() * RotationFromVector({0.0, 0.0, i == 0 ? 0.03 : -0.03});
    traverse.links[i].result.T_target_source =
        traverse.poses[link.target].T_segment_scan.inverse() * T_wrong * traverse.poses[link.source].T_segment_scan;
  }
  traverse.links.push_back(traverse.links[1]);
  EXPECT_THAT(PlaceSegments(traverse, {}).at(1).T_root_segment, IsNear(T_true, 1e-9, 1e-9));
}

TEST(PlaceSegmentsTest, TheLowerNumberNeedNotBeTheLinksTarget) {
  Traverse traverse = ThreeSegments();
  std::swap(traverse.poses[0].segment, traverse.poses[8].segment);  // pose 0 now of segment 2, pose 8 of segment 0
  Link(traverse, 8, 3);
  const SegmentPlaces places = PlaceSegments(traverse, {});
  EXPECT_EQ(places.at(1).root, 0);
  EXPECT_THAT(places.at(1).T_root_segment, IsNear(kTrueFrames[0].inverse() * kTrueFrames[1], 1e-9, 1e-9));
}

}  // namespace
}  // namespace curvereg
