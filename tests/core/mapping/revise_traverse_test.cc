// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "core/mapping/pose_uncertainty.h"
#include "core/mapping/revise_traverse.h"
#include "core/mapping/traverse_changes.h"
#include "sim/random.h"
#include "tests/testing/matchers.h"

namespace curvereg {
namespace {

using testing::HasCode;
using testing::IsNear;
using testing::IsOk;

constexpr double kLinkM = 1e-3;  // error of good links, each axis
constexpr double kLinkRad = 5e-5;

// A drive round a circle of 30 scans, 5 m apart: the truth, and links and poses as registrations would give them.
class DriveMaker {
 public:
  explicit DriveMaker(uint64_t num_scans) : random_(3) {
    for (uint64_t i = 0; i < num_scans; ++i) {
      const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / 30.0;
      const double radius_m = 24.0;
      Vector6d pose;
      pose << 0.02 * std::sin(angle), 0.02 * std::cos(angle), angle, radius_m * std::sin(angle),
          -radius_m * std::cos(angle), std::sin(3.0 * angle);
      T_world_scan_.push_back(TransformFromVector(pose));
    }
  }

  RigidTransform TrueMotion(uint64_t target, uint64_t source) const {
    return T_world_scan_[target].inverse() * T_world_scan_[source];
  }

  TraverseLink Link(uint64_t source, uint64_t target, LinkKind kind = LinkKind::kTracking) {
    TraverseLink link{source, target, kind, {}};
    link.result.T_target_source = Noise(kLinkRad, kLinkM) * TrueMotion(target, source);
    Vector6d variances;
    variances << Eigen::Vector3d::Constant(kLinkRad * kLinkRad), Eigen::Vector3d::Constant(kLinkM * kLinkM);
    link.result.covariance = variances.asDiagonal();
    link.result.verdict = {true, {}};
    return link;
  }

  // Adds the next scan, `source`, with a pose chained from `target` (none: a new segment).
  void Append(Traverse& traverse, const std::vector<TraverseLink>& links) {
    TrackedScan tracked;
    tracked.pose.sequence_number = traverse.poses.size();
    tracked.pose.covariance = Matrix6d::Zero();
    tracked.links = links;
    if (links.empty()) {
      tracked.pose.segment = traverse.num_segments;
    } else {
      const TrajectoryPose& target = traverse.poses[links[0].target];
      tracked.pose.segment = target.segment;
      const Matrix6d covariance = LinkCovariance(links[0].result, PoseGraphOptions{});
      const Prior T_segment_scan =
          Chained({target.T_segment_scan, target.covariance}, {*links[0].result.T_target_source, covariance});
      tracked.pose.T_segment_scan = T_segment_scan.T_target_source;
      tracked.pose.covariance = T_segment_scan.covariance;
      tracked.pose.origin = PoseOrigin::kRegistered;
    }
    AppendScan(traverse, tracked, std::nullopt);
  }

  // All scans tracked, and each linked with `num_more` scans before its predecessor.
  Traverse Drive(uint64_t num_more) {
    Traverse traverse;
    for (uint64_t i = 0; i < T_world_scan_.size(); ++i) {
      Append(traverse, i == 0 ? std::vector<TraverseLink>{} : std::vector<TraverseLink>{Link(i, i - 1)});
    }
    for (uint64_t i = 0; i < T_world_scan_.size(); ++i) {
      for (uint64_t k = 2; k < 2 + num_more && k <= i; ++k) {
        traverse.links.push_back(Link(i, i - k, LinkKind::kNeighbour));
      }
    }
    return traverse;
  }

  RigidTransform Noise(double sigma_rad, double sigma_m) {
    Vector6d delta;
    for (int i = 0; i < 6; ++i) delta[i] = (i < 3 ? sigma_rad : sigma_m) * random_.Normal();
    return TransformFromVector(delta);
  }

  RigidTransform AnyTransform() {
    Vector6d delta;
    for (int i = 0; i < 6; ++i) delta[i] = i < 3 ? random_.Uniform(-1.0, 1.0) : random_.Uniform(-15.0, 15.0);
    return TransformFromVector(delta);
  }

  sim::RandomStream& random() { return random_; }

 private:
  std::vector<RigidTransform> T_world_scan_;
  sim::RandomStream random_;
};

TEST(ReviseTraverseTest, WithoutCyclesNothingChanges) {
  EXPECT_TRUE(ReviseTraverse(Traverse{}, {})->poses.empty());
  DriveMaker maker(10);
  Traverse traverse = maker.Drive(0);
  traverse.links.push_back(maker.Link(9, 0));
  traverse.links.back().result.verdict = {false, {Reason::kAmbiguous}};
  const auto revision = ReviseTraverse(traverse, {});
  ASSERT_THAT(revision, IsOk());
  EXPECT_TRUE(revision->poses.empty());
  EXPECT_TRUE(revision->joins.empty());
  EXPECT_EQ(revision->num_links, 9);
  EXPECT_EQ(revision->num_rejected_links, 0);
  ApplyRevision(traverse, *revision);
  EXPECT_EQ(traverse.version, 0U);
}

double WorstError(const Traverse& traverse, const DriveMaker& maker) {
  double worst = 0.0;
  for (const TrajectoryPose& pose : traverse.poses) {
    const RigidTransform T_true = maker.TrueMotion(0, pose.sequence_number);
    worst = std::max(worst, (pose.T_segment_scan.translation() - T_true.translation()).norm());
  }
  return worst;
}

TEST(ReviseTraverseTest, ALoopClosureTakesTheDriftAway) {
  DriveMaker maker(30);
  Traverse traverse = maker.Drive(0);
  // A small turn to the side at each step.
  RigidTransform T_drifted = RigidTransform::Identity();
  for (uint64_t i = 1; i < 30; ++i) {
    RigidTransform& T = *traverse.links[i - 1].result.T_target_source;
    T.linear() = RotationFromVector({0.0, 0.0, 5e-5}) * T.linear();
    T_drifted = T_drifted * T;
    traverse.poses[i].T_segment_scan = T_drifted;
  }
  traverse.links.push_back(maker.Link(29, 0, LinkKind::kLoopClosure));
  const double before = WorstError(traverse, maker);
  const auto revision = ReviseTraverse(traverse, {});
  ASSERT_THAT(revision, IsOk());
  EXPECT_EQ(revision->num_links, 30);
  EXPECT_GT(revision->max_translation_change_m, 0.3 * before);
  EXPECT_GT(before, 0.02);
  ApplyRevision(traverse, *revision);
  EXPECT_EQ(traverse.version, 1U);
  EXPECT_LT(WorstError(traverse, maker), 0.6 * before);
  EXPECT_THAT(traverse.poses[0].T_segment_scan, IsNear(RigidTransform::Identity(), 1e-12, 1e-12));
  for (const TrajectoryPose& pose : revision->poses) ASSERT_TRUE(pose.covariance.has_value());
}

TEST(ReviseTraverseTest, WhatHasSettledIsNotToldAgain) {
  DriveMaker maker(30);
  Traverse traverse = maker.Drive(2);
  ApplyRevision(traverse, *ReviseTraverse(traverse, {}));
  const auto again = ReviseTraverse(traverse, {});
  ASSERT_THAT(again, IsOk());
  EXPECT_TRUE(again->poses.empty()) << again->poses.size() << " of 30, by " << again->max_translation_change_m;
}

// One link in ten is wrong by any amount, tracking links and their poses included or not.
void ExpectWrongLinksToMoveNothing(bool also_tracking) {
  DriveMaker maker(40);
  Traverse clean = maker.Drive(3);
  Traverse traverse = clean;
  int num_wrong = 0;
  for (size_t i = 0; i < traverse.links.size(); ++i) {
    TraverseLink& link = traverse.links[i];
    if (maker.random().Uniform() > 0.1 || (!also_tracking && link.kind == LinkKind::kTracking)) continue;
    link.result.T_target_source = maker.AnyTransform();
    ++num_wrong;
  }
  ASSERT_GE(num_wrong, 8);
  for (uint64_t i = 1; i < 40; ++i) {
    const TraverseLink& link = traverse.links[i - 1];
    traverse.poses[i].T_segment_scan = traverse.poses[link.target].T_segment_scan * *link.result.T_target_source;
  }
  for (Traverse* each : {&clean, &traverse}) {
    const auto revision = ReviseTraverse(*each, {});
    ASSERT_THAT(revision, IsOk());
    EXPECT_EQ(revision->num_rejected_links, each == &clean ? 0 : num_wrong);
    ApplyRevision(*each, *revision);
  }
  EXPECT_LT(WorstError(clean, maker), 0.02);
  for (size_t i = 0; i < 40; ++i) {
    EXPECT_THAT(traverse.poses[i].T_segment_scan, IsNear(clean.poses[i].T_segment_scan, 0.02, 0.002)) << i;
  }
}

TEST(ReviseTraverseTest, WrongNeighbourLinksMoveNothing) { ExpectWrongLinksToMoveNothing(false); }
TEST(ReviseTraverseTest, WrongTrackingLinksMoveNothing) { ExpectWrongLinksToMoveNothing(true); }

// Scans 0 to 9 are segment 0; 10 to 19 begin anew.
Traverse BrokenDrive(DriveMaker& maker) {
  Traverse traverse;
  for (uint64_t i = 0; i < 20; ++i) {
    maker.Append(traverse, i % 10 == 0 ? std::vector<TraverseLink>{} : std::vector<TraverseLink>{maker.Link(i, i - 1)});
  }
  return traverse;
}

TEST(ReviseTraverseTest, AnAcceptedLinkJoinsSegments) {
  DriveMaker maker(20);
  Traverse traverse = BrokenDrive(maker);
  ASSERT_EQ(traverse.num_segments, 2);
  traverse.links.push_back(maker.Link(12, 8, LinkKind::kNeighbour));
  const auto revision = ReviseTraverse(traverse, {});
  ASSERT_THAT(revision, IsOk());
  ASSERT_EQ(revision->joins.size(), 1U);
  EXPECT_EQ(revision->joins[0].segment, 0);
  EXPECT_EQ(revision->joins[0].joined_segment, 1);
  EXPECT_THAT(revision->joins[0].T_segment_joined, IsNear(maker.TrueMotion(0, 10), 0.05, 0.005));
  EXPECT_EQ(revision->poses.size(), 10U);
  EXPECT_LT(revision->max_translation_change_m, 1e-9);
  ApplyRevision(traverse, *revision);
  for (const TrajectoryPose& pose : traverse.poses) {
    EXPECT_EQ(pose.segment, 0);
    EXPECT_EQ(pose.origin, pose.sequence_number == 0 ? PoseOrigin::kSegmentStart : PoseOrigin::kRegistered);
  }
  EXPECT_LT(WorstError(traverse, maker), 0.05);
}

TEST(ReviseTraverseTest, AWrongJoinIsOutvoted) {
  DriveMaker maker(20);
  Traverse traverse = BrokenDrive(maker);
  traverse.links.push_back(maker.Link(11, 3, LinkKind::kNeighbour));
  traverse.links.back().result.T_target_source = maker.AnyTransform();
  traverse.links.push_back(maker.Link(12, 8, LinkKind::kNeighbour));
  traverse.links.push_back(maker.Link(13, 9, LinkKind::kNeighbour));
  const auto revision = ReviseTraverse(traverse, {});
  ASSERT_THAT(revision, IsOk());
  EXPECT_EQ(revision->joins.size(), 1U);
  EXPECT_EQ(revision->num_rejected_links, 1);
  EXPECT_EQ(revision->num_links, 20);
  ApplyRevision(traverse, *revision);
  EXPECT_LT(WorstError(traverse, maker), 0.05);
}

TEST(ReviseTraverseTest, OdometryHoldsWhereNoLinkDoes) {
  DriveMaker maker(20);
  Traverse traverse = maker.Drive(0);
  const Matrix6d covariance = 1e-2 * Matrix6d::Identity();
  for (uint64_t i = 1; i < 20; ++i) traverse.priors[i] = Prior{maker.TrueMotion(i - 1, i), covariance};
  std::erase_if(traverse.links, [](const TraverseLink& link) { return link.source == 10; });
  traverse.poses[10].origin = PoseOrigin::kPrior;
  traverse.priors[5]->T_target_source.translation().x() += 3.0;  // the wheels slipped
  const auto revision = ReviseTraverse(traverse, {});
  ASSERT_THAT(revision, IsOk());
  EXPECT_EQ(revision->num_rejected_links, 0);
  ApplyRevision(traverse, *revision);
  EXPECT_LT(WorstError(traverse, maker), 0.05);
  EXPECT_EQ(traverse.poses[10].origin, PoseOrigin::kPrior);
  ASSERT_TRUE(traverse.poses[15].covariance.has_value());
  EXPECT_GT((*traverse.poses[15].covariance)(5, 5), 0.9e-2);
  // A registration found later takes the place of odometry.
  traverse.links.push_back(maker.Link(10, 8, LinkKind::kNeighbour));
  ApplyRevision(traverse, *ReviseTraverse(traverse, {}));
  EXPECT_EQ(traverse.poses[10].origin, PoseOrigin::kRegistered);
  EXPECT_LT((*traverse.poses[15].covariance)(5, 5), 1e-3);
}

// A registration of little certainty that odometry contradicts.
TEST(ReviseTraverseTest, OdometryHoldsWhereTheOnlyLinkIsGivenUp) {
  DriveMaker maker(20);
  Traverse traverse = maker.Drive(0);
  traverse.priors[11] = Prior{maker.TrueMotion(10, 11), 1e-4 * Matrix6d::Identity()};
  RegistrationResult& wrong = traverse.links[10].result;
  wrong.T_target_source->translation().x() += 20.0;
  wrong.covariance->bottomRightCorner<3, 3>() = Eigen::Matrix3d::Identity();
  for (size_t i = 11; i < 20; ++i) {
    traverse.poses[i].T_segment_scan =
        traverse.poses[i - 1].T_segment_scan * *traverse.links[i - 1].result.T_target_source;
  }
  const auto revision = ReviseTraverse(traverse, {});
  ASSERT_THAT(revision, IsOk());
  EXPECT_EQ(revision->num_rejected_links, 1);
  EXPECT_TRUE(revision->converged);
  ApplyRevision(traverse, *revision);
  EXPECT_LT(WorstError(traverse, maker), 0.1);
  for (const TrajectoryPose& pose : traverse.poses) {
    const uint64_t number = pose.sequence_number;
    EXPECT_EQ(pose.origin, number == 0    ? PoseOrigin::kSegmentStart
                           : number == 11 ? PoseOrigin::kPrior
                                          : PoseOrigin::kRegistered);
  }
  // A link of a later scan ties it to the others again, round about.
  traverse.links.push_back(maker.Link(12, 9, LinkKind::kNeighbour));
  ApplyRevision(traverse, *ReviseTraverse(traverse, {}));
  EXPECT_EQ(traverse.poses[11].origin, PoseOrigin::kRegistered);
}

// Links that contradict each other are all that holds the second half: one of them is believed.
TEST(ReviseTraverseTest, ASegmentIsNotSplit) {
  DriveMaker maker(20);
  Traverse traverse = maker.Drive(0);
  for (const uint64_t source : {11, 12, 13}) {
    if (source > 11) traverse.links.push_back(maker.Link(source, 9, LinkKind::kNeighbour));
    TraverseLink& link = source == 11 ? traverse.links[10] : traverse.links.back();
    link.result.T_target_source = maker.AnyTransform();
  }
  const auto revision = ReviseTraverse(traverse, {});
  ASSERT_THAT(revision, IsOk());
  EXPECT_EQ(revision->num_rejected_links, 2);
  EXPECT_EQ(revision->num_links, 19);
  ApplyRevision(traverse, *revision);
  for (const TrajectoryPose& pose : traverse.poses) {
    EXPECT_EQ(pose.segment, 0);
    EXPECT_EQ(pose.origin, pose.sequence_number == 0 ? PoseOrigin::kSegmentStart : PoseOrigin::kRegistered);
  }
  // Each half still holds together.
  EXPECT_THAT(traverse.poses[12].T_segment_scan.inverse() * traverse.poses[19].T_segment_scan,
              IsNear(maker.TrueMotion(12, 19), 0.05, 0.005));
}

TEST(ReviseTraverseTest, TellsThatPosesStillMoved) {
  DriveMaker maker(30);
  const Traverse traverse = maker.Drive(2);
  EXPECT_TRUE(ReviseTraverse(traverse, {})->converged);
  TrackingOptions options;
  options.pose_graph.max_iterations = 1;
  EXPECT_FALSE(ReviseTraverse(traverse, options)->converged);
}

TEST(ReviseTraverseTest, EndsWhenAsked) {
  DriveMaker maker(10);
  std::stop_source source;
  source.request_stop();
  EXPECT_THAT(ReviseTraverse(maker.Drive(2), {}, {source.get_token(), std::nullopt}),
              HasCode(absl::StatusCode::kCancelled));
}

}  // namespace
}  // namespace curvereg
