// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/trajectory_conversion.h"

#include <limits>
#include <optional>

#include "wire/error.h"
#include "wire/geometry_conversion.h"
#include "wire/timestamp.h"

namespace curvereg::wire {
namespace {

v1::PoseOrigin ToWire(PoseOrigin origin) {
  switch (origin) {
    case PoseOrigin::kSegmentStart:
      return v1::POSE_ORIGIN_SEGMENT_START;
    case PoseOrigin::kRegistered:
      return v1::POSE_ORIGIN_REGISTERED;
    case PoseOrigin::kPrior:
      return v1::POSE_ORIGIN_PRIOR;
  }
  return v1::POSE_ORIGIN_UNSPECIFIED;
}

absl::StatusOr<PoseOrigin> OriginFromWire(v1::PoseOrigin origin) {
  switch (origin) {
    case v1::POSE_ORIGIN_SEGMENT_START:
      return PoseOrigin::kSegmentStart;
    case v1::POSE_ORIGIN_REGISTERED:
      return PoseOrigin::kRegistered;
    case v1::POSE_ORIGIN_PRIOR:
      return PoseOrigin::kPrior;
    default:
      return FieldError("origin", "not a known origin");
  }
}

}  // namespace

v1::TrajectoryPose ToWire(const TrajectoryPose& pose) {
  v1::TrajectoryPose message;
  message.set_sequence_number(pose.sequence_number);
  if (pose.time_ns.has_value()) *message.mutable_time() = TimestampOf(*pose.time_ns);
  message.set_segment(static_cast<uint32_t>(pose.segment));
  *message.mutable_t_segment_sensor() = ToWire(pose.T_segment_scan);
  if (pose.covariance.has_value() && pose.covariance->allFinite())
    *message.mutable_covariance() = ToWire(*pose.covariance);
  message.set_origin(ToWire(pose.origin));
  return message;
}

absl::StatusOr<TrajectoryPose> FromWire(const v1::TrajectoryPose& message) {
  TrajectoryPose pose;
  pose.sequence_number = message.sequence_number();
  if (message.has_time()) {
    pose.time_ns = NanosecondsOf(message.time());
    if (!pose.time_ns.has_value()) return FieldError("time", "out of range");
  }
  const absl::StatusOr<int> segment = SegmentFromWire(message.segment());
  if (!segment.ok()) return segment.status();
  pose.segment = *segment;
  const absl::StatusOr<RigidTransform> T_segment_scan = FromWire(message.t_segment_sensor());
  if (!T_segment_scan.ok()) return WithinField("t_segment_sensor", T_segment_scan.status());
  pose.T_segment_scan = *T_segment_scan;
  const absl::StatusOr<PoseOrigin> origin = OriginFromWire(message.origin());
  if (!origin.ok()) return origin.status();
  pose.origin = *origin;
  if (!message.has_covariance()) return pose;
  const absl::StatusOr<Matrix6d> covariance = SymmetricFromWire(message.covariance());
  if (!covariance.ok()) return WithinField("covariance", covariance.status());
  if (covariance->diagonal().minCoeff() < 0.0) {
    return FieldError("covariance.upper_triangle", "negative on its diagonal");
  }
  pose.covariance = *covariance;
  return pose;
}

absl::StatusOr<int> SegmentFromWire(uint32_t segment) {
  if (segment > static_cast<uint32_t>(std::numeric_limits<int>::max())) return FieldError("segment", "out of range");
  return static_cast<int>(segment);
}

}  // namespace curvereg::wire
