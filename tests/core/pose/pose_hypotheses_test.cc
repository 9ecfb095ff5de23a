// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pose/pose_hypotheses.h"

#include <gtest/gtest.h>

#include "core/scan/leveling.h"
#include "core/scan/scan.h"
#include "tests/testing/matchers.h"
#include "tests/testing/same_bytes.h"
#include "tests/testing/scenes.h"

namespace curvereg {
namespace {

ViewFeatures ViewOf(const Scan& scan, const ViewOptions& options) {
  const auto verticals = FindVerticals(BuildVoxelMaps(scan.points), std::nullopt);
  return *ComputeViewFeatures(scan.points, verticals.front().R_level_sensor, options);
}

struct Pair {
  Scan source;
  Scan target;
  RigidTransform T_target_source;
};

Pair GroundPair(const RigidTransform& T_world_source, const RigidTransform& T_world_target) {
  return {testing::BumpyGround(T_world_source, {.noise_seed = 1}),
          testing::BumpyGround(T_world_target, {.noise_seed = 2}), T_world_target.inverse() * T_world_source};
}

TEST(FindPoseHypothesesTest, ElevationViewsOfUnevenGroundPutTheTruthFirst) {
  for (const double yaw : {0.3, 2.6}) {
    const Pair pair = GroundPair(testing::RoverPose(3.0, 1.0, yaw), testing::RoverPose(0.0, 0.0, 0.0));
    const ViewOptions options = ElevationViewOptions();
    const HypothesesFromViews found =
        FindPoseHypotheses(ViewOf(pair.source, options), ViewOf(pair.target, options), {});
    ASSERT_FALSE(found.hypotheses.empty());
    EXPECT_GT(found.num_matches, 20);
    EXPECT_GE(found.hypotheses[0].num_inliers, 10);
    EXPECT_THAT(found.hypotheses[0].T_target_source, testing::IsNear(pair.T_target_source, 0.4, 0.05));
  }
}

TEST(FindPoseHypothesesTest, TheHeightIsRecoveredToo) {
  const Pair pair = GroundPair(testing::RoverPose(1.0, 1.0, 0.2, 2.6), testing::RoverPose(0.0, 0.0, 0.0, 1.6));
  const ViewOptions options = ElevationViewOptions();
  const HypothesesFromViews found = FindPoseHypotheses(ViewOf(pair.source, options), ViewOf(pair.target, options), {});
  ASSERT_FALSE(found.hypotheses.empty());
  EXPECT_NEAR(found.hypotheses[0].T_target_source.translation().z(), pair.T_target_source.translation().z(), 0.15);
}

TEST(FindPoseHypothesesTest, OccupancyViewsOfAHallHoldTheTruth) {
  const RigidTransform T_world_source = testing::UprightPose(-1.5, 0.6, 1.0, 2.1);
  const RigidTransform T_world_target = testing::UprightPose(0.5, 0.2, 0.3, 1.6);
  testing::ScannerOptions scanner;
  scanner.max_elevation_rad = 0.7;
  const Scan source = testing::FurnishedHall(T_world_source, scanner);
  const Scan target = testing::FurnishedHall(T_world_target, scanner);
  ViewOptions options = OccupancyViewOptions();
  const auto level = Eigen::Matrix3d::Identity();
  const HypothesesFromViews found =
      FindPoseHypotheses(*ComputeViewFeatures(source.points, level, options),
                         *ComputeViewFeatures(target.points, level, options), {.max_hypotheses = 24});
  const RigidTransform T_true = T_world_target.inverse() * T_world_source;
  bool holds = false;
  for (const PoseHypothesis& hypothesis : found.hypotheses) {
    const TransformDifference difference = Difference(T_true, hypothesis.T_target_source);
    holds = holds || (difference.translation_m < 0.6 && difference.rotation_rad < 0.15);
  }
  EXPECT_TRUE(holds) << found.hypotheses.size() << " hypotheses from " << found.num_matches << " matches";
}

TEST(FindPoseHypothesesTest, MostInliersFirst) {
  const Pair pair = GroundPair(testing::RoverPose(3.0, 1.0, 0.3), testing::RoverPose(0.0, 0.0, 0.0));
  const ViewOptions options = ElevationViewOptions();
  const auto found = FindPoseHypotheses(ViewOf(pair.source, options), ViewOf(pair.target, options), {.min_inliers = 2});
  for (size_t i = 1; i < found.hypotheses.size(); ++i) {
    EXPECT_GE(found.hypotheses[i - 1].num_inliers, found.hypotheses[i].num_inliers);
  }
  for (const PoseHypothesis& hypothesis : found.hypotheses) EXPECT_TRUE(IsRigid(hypothesis.T_target_source));
}

TEST(FindPoseHypothesesTest, ViewsWithoutFeaturesGiveNone) {
  for (const ViewOptions& options : {ElevationViewOptions(), OccupancyViewOptions()}) {
    const ViewFeatures empty = *ComputeViewFeatures({}, Eigen::Matrix3d::Identity(), options);
    const HypothesesFromViews found = FindPoseHypotheses(empty, empty, {});
    EXPECT_TRUE(found.hypotheses.empty());
    EXPECT_EQ(found.num_matches, 0);
  }
}

TEST(FindPoseHypothesesTest, SameBytesAtAnyThreadCount) {
  const Pair pair = GroundPair(testing::RoverPose(3.0, 1.0, 0.3), testing::RoverPose(0.0, 0.0, 0.0));
  const ViewOptions options = ElevationViewOptions();
  const ViewFeatures source = ViewOf(pair.source, options);
  const ViewFeatures target = ViewOf(pair.target, options);
  testing::ExpectSameBytesAtAnyThreadCount([&](testing::ByteLog& log) {
    for (const PoseHypothesis& hypothesis : FindPoseHypotheses(source, target, {}).hypotheses) {
      log.Add(hypothesis.T_target_source.data(), 16);
      log.Add(hypothesis.num_inliers);
    }
  });
}

}  // namespace
}  // namespace curvereg
