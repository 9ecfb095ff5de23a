// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Poses of a trajectory to and from the contract. Errors as in geometry_conversion.h.
#ifndef CURVEREG_WIRE_TRAJECTORY_CONVERSION_H_
#define CURVEREG_WIRE_TRAJECTORY_CONVERSION_H_

#include "absl/status/statusor.h"
#include "core/mapping/trajectory.h"
#include "curvereg/v1/traverse_service.pb.h"

namespace curvereg::wire {

v1::TrajectoryPose ToWire(const TrajectoryPose& pose);
// The covariance may be singular (that of a segment's first pose is zero), but not negative on its diagonal.
absl::StatusOr<TrajectoryPose> FromWire(const v1::TrajectoryPose& message);

// The number of a segment.
absl::StatusOr<int> SegmentFromWire(uint32_t segment);

}  // namespace curvereg::wire

#endif  // CURVEREG_WIRE_TRAJECTORY_CONVERSION_H_
