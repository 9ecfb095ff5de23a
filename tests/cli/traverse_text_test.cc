// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/traverse_text.h"

#include <nlohmann/json.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/traverse_trajectory.h"
#include "files/json.h"
#include "tests/testing/scenes.h"

namespace curvereg::cli {
namespace {

nlohmann::json Parsed(const Json& json) { return nlohmann::json::parse(JsonText(json)); }

using ::testing::HasSubstr;

TrajectoryPose PoseAt(double x, double y, int segment = 0) {
  TrajectoryPose pose;
  pose.segment = segment;
  pose.T_segment_scan = curvereg::testing::UprightPose(x, y, 0.0, 0.0);
  return pose;
}

TEST(TraverseTextTest, TheRotationCountsWithItsLever) {
  TrajectoryPose pose = PoseAt(10.0, 0.0);
  EXPECT_FALSE(PositionSigma(pose).has_value());
  Vector6d variances;
  variances << 0, 0, 1e-4, 1e-6, 1e-6, 1e-6;  // yaw by 0.01 rad at 10 m: 0.1 m across
  pose.covariance = Matrix6d(variances.asDiagonal());
  const Eigen::Matrix3d covariance = *PositionCovariance(pose);
  EXPECT_NEAR(covariance(0, 0), 1e-6, 1e-12);
  EXPECT_NEAR(covariance(1, 1), 1e-2 + 1e-6, 1e-12);
  EXPECT_NEAR(covariance(2, 2), 1e-6, 1e-12);
  EXPECT_NEAR(*PositionSigma(pose), std::sqrt(1e-2 + 1e-6), 1e-9);
}

TEST(TraverseTextTest, ARowTellsTheVerdict) {
  ScanResult result;
  result.sequence_number = 12;
  result.pose = PoseAt(1.5, -2.25, 3);
  result.pose.origin = PoseOrigin::kPrior;
  LinkSummary link;
  link.source = 12;
  link.target = 11;
  link.reasons = {Reason::kOverlapTooLow};
  link.overlap = 0.125;
  result.links = {link};
  const std::string row = ScanResultRow(result);
  EXPECT_THAT(row, HasSubstr("12   3      1.500     -2.250"));
  EXPECT_THAT(row, HasSubstr("0.125"));
  EXPECT_THAT(row, HasSubstr("prior (overlap_too_low)"));
  EXPECT_EQ(row.find('\n'), row.size() - 1);
  EXPECT_EQ(ScanResultHeader().find("verdict"), row.find("prior"));
}

TEST(TraverseTextTest, TellsWhenAnOptimisationDidNotConverge) {
  OptimizationOutcome outcome;
  EXPECT_EQ(OptimizationText(outcome).find("converged"), std::string::npos);
  EXPECT_EQ(Parsed(OptimizationJson(outcome))["converged"], true);
  outcome.converged = false;
  EXPECT_THAT(OptimizationText(outcome), HasSubstr("not converged"));
  EXPECT_EQ(Parsed(OptimizationJson(outcome))["converged"], false);
}

TEST(TraverseTextTest, JsonHasNullWhereNothingIsKnown) {
  TraverseEvent event;
  event.number = 7;
  ScanResult result;
  result.pose = PoseAt(1, 2);
  event.what = result;
  const nlohmann::json json = Parsed(EventJson(event));
  EXPECT_EQ(json["event"], 7);
  EXPECT_EQ(json["time"], "1970-01-01T00:00:00+00:00");
  EXPECT_TRUE(json["result"]["result"].is_null());
  EXPECT_TRUE(json["result"]["pose"]["covariance"].is_null());
  EXPECT_TRUE(json["result"]["pose"]["time_ns"].is_null());
  EXPECT_EQ(json["result"]["pose"]["T_segment_scan"][0][3], 1.0);
  EXPECT_EQ(json["result"]["pose"]["origin"], "segment_start");
}

TEST(TraverseTextTest, ATrajectoryHasTheTimesOfOneSegment) {
  std::vector<TrajectoryPose> poses = {PoseAt(0, 0), PoseAt(1, 0, 1), PoseAt(2, 0, 1)};
  for (uint64_t i = 0; i < 3; ++i) poses[i].sequence_number = i;
  EXPECT_EQ(LargestSegment(poses), 1);
  EXPECT_EQ(LargestSegment({}), 0);
  poses[1].time_ns = 5'000'000'000;
  EXPECT_EQ(PosesOf(poses, 1)[0].timestamp_s, 1.0) << "the other has no time";
  poses[2].time_ns = 6'500'000'000;
  const std::vector<StampedPose> stamped = PosesOf(poses, 1);
  ASSERT_EQ(stamped.size(), 2U);
  EXPECT_EQ(stamped[1].timestamp_s, 6.5);
  EXPECT_EQ(stamped[1].T_world_scan.translation().x(), 2.0);
}

}  // namespace
}  // namespace curvereg::cli
