// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/trajectory_conversion.h"

#include <gtest/gtest.h>

#include <limits>

#include "wire/error.h"

namespace curvereg::wire {
namespace {

TrajectoryPose SomePose() {
  TrajectoryPose pose;
  pose.sequence_number = 17;
  pose.time_ns = 1'795'000'000'123'456'789;
  pose.segment = 3;
  pose.T_segment_scan = TransformFromVector((Vector6d() << 0.1, -0.2, 0.3, 4.0, 5.0, -6.0).finished());
  pose.covariance = 1e-4 * Matrix6d::Identity();
  (*pose.covariance)(1, 4) = (*pose.covariance)(4, 1) = 5e-5;
  pose.origin = PoseOrigin::kPrior;
  return pose;
}

TEST(TrajectoryConversionTest, APoseComesBack) {
  const absl::StatusOr<TrajectoryPose> back = FromWire(ToWire(SomePose()));
  ASSERT_TRUE(back.ok()) << back.status();
  const TrajectoryPose pose = SomePose();
  EXPECT_EQ(back->sequence_number, pose.sequence_number);
  EXPECT_EQ(back->time_ns, pose.time_ns);
  EXPECT_EQ(back->segment, pose.segment);
  EXPECT_TRUE(back->T_segment_scan.isApprox(pose.T_segment_scan, 1e-15));
  EXPECT_EQ(*back->covariance, *pose.covariance);
  EXPECT_EQ(back->origin, pose.origin);
}

TEST(TrajectoryConversionTest, EveryOriginComesBack) {
  for (const PoseOrigin origin : {PoseOrigin::kSegmentStart, PoseOrigin::kRegistered, PoseOrigin::kPrior}) {
    TrajectoryPose pose;
    pose.origin = origin;
    EXPECT_EQ(FromWire(ToWire(pose))->origin, origin);
  }
}

TEST(TrajectoryConversionTest, WhatIsUnknownStaysUnknown) {
  TrajectoryPose pose;
  const absl::StatusOr<TrajectoryPose> back = FromWire(ToWire(pose));
  ASSERT_TRUE(back.ok());
  EXPECT_FALSE(back->time_ns.has_value());
  EXPECT_FALSE(back->covariance.has_value());
  pose.covariance = Matrix6d::Constant(std::numeric_limits<double>::infinity());
  EXPECT_FALSE(ToWire(pose).has_covariance()) << "an endless covariance is none";
}

TEST(TrajectoryConversionTest, TheFirstPoseOfASegmentIsSureOfItself) {
  TrajectoryPose pose;
  pose.covariance = Matrix6d::Zero();
  EXPECT_EQ(*FromWire(ToWire(pose))->covariance, Matrix6d::Zero());
}

TEST(TrajectoryConversionTest, RefusesNonsense) {
  const v1::TrajectoryPose good = ToWire(SomePose());
  v1::TrajectoryPose bad = good;
  bad.set_segment(1U << 31);
  EXPECT_TRUE(absl::IsInvalidArgument(FromWire(bad).status()));
  bad = good;
  bad.mutable_time()->set_nanos(-1);
  EXPECT_TRUE(absl::IsInvalidArgument(FromWire(bad).status()));
  bad = good;
  bad.clear_t_segment_sensor();
  EXPECT_TRUE(absl::IsInvalidArgument(FromWire(bad).status()));
  bad = good;
  bad.set_origin(v1::POSE_ORIGIN_UNSPECIFIED);
  EXPECT_TRUE(absl::IsInvalidArgument(FromWire(bad).status()));
  bad = good;
  bad.mutable_covariance()->add_upper_triangle(1.0);
  EXPECT_TRUE(absl::IsInvalidArgument(FromWire(bad).status()));
  bad = good;
  bad.mutable_covariance()->set_upper_triangle(0, -1.0);
  EXPECT_TRUE(absl::IsInvalidArgument(FromWire(bad).status()));
  EXPECT_EQ(BadRequestOf(FromWire(bad).status())->field_violations(0).field(), "covariance.upper_triangle");
  bad = good;
  bad.mutable_covariance()->set_upper_triangle(1, std::numeric_limits<double>::quiet_NaN());
  EXPECT_TRUE(absl::IsInvalidArgument(FromWire(bad).status()));
}

}  // namespace
}  // namespace curvereg::wire
