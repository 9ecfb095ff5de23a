// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/trajectory_conversion.h"

#include <limits>
#include <optional>

#include "wire/conversion.h"
#include "wire/error.h"
#include "wire/timestamp.h"

namespace curvereg::wire {
namespace {

constexpr int kUpperTriangle = 21;  // numbers of a symmetric 6x6 matrix

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

absl::StatusOr<Matrix6d> CovarianceFromWire(const v1::PoseCovariance& message) {
  if (message.upper_triangle_size() != kUpperTriangle) return FieldError("covariance", "not 21 numbers");
  Matrix6d covariance;
  int next = 0;
  for (int row = 0; row < 6; ++row) {
    for (int col = row; col < 6; ++col) covariance(row, col) = covariance(col, row) = message.upper_triangle(next++);
  }
  if (!covariance.allFinite() || covariance.diagonal().minCoeff() < 0.0) {
    return FieldError("covariance", "not the covariance of anything");
  }
  return covariance;
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
  const absl::StatusOr<Matrix6d> covariance = CovarianceFromWire(message.covariance());
  if (!covariance.ok()) return covariance.status();
  pose.covariance = *covariance;
  return pose;
}

absl::StatusOr<int> SegmentFromWire(uint32_t segment) {
  if (segment > static_cast<uint32_t>(std::numeric_limits<int>::max())) return FieldError("segment", "out of range");
  return static_cast<int>(segment);
}

}  // namespace curvereg::wire
