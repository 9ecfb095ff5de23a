// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What is known of a traverse, a rover's drive from scan to scan: poses, the links between scans that support them, and
// the segments that hold together. Plain data: a server rebuilds it from what it stored.
#ifndef CURVEREG_CORE_MAPPING_TRAJECTORY_H_
#define CURVEREG_CORE_MAPPING_TRAJECTORY_H_

#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/rigid_transform.h"
#include "core/methods/registration_options.h"
#include "core/methods/registration_result.h"

namespace curvereg {

// How a pose came about.
enum class PoseOrigin {
  kSegmentStart,  // first of its segment, whose frame is this scan's sensor frame
  kRegistered,    // by accepted registrations; in a revised trajectory, by such as were not given up
  kPrior,         // no registration was accepted, or all were rejected later; carried by the prior
};

struct TrajectoryPose {
  uint64_t sequence_number = 0;
  std::optional<int64_t> time_ns;  // since 1970-01-01 UTC
  int segment = 0;                 // frames of different segments are unrelated
  RigidTransform T_segment_scan = RigidTransform::Identity();
  // Of (rotation [rad], translation [m]), left perturbation, segment frame, relative to the segment's first pose.
  // Absent: unknown.
  std::optional<Matrix6d> covariance;
  PoseOrigin origin = PoseOrigin::kSegmentStart;
};

enum class LinkKind {
  kTracking,     // with the scan before, or another that was tried for the first pose of a scan
  kNeighbour,    // with a kept scan nearby, found after the first pose
  kLoopClosure,  // with a scan that the path came back to
};

// A registration of two scans of the traverse, accepted or not.
struct TraverseLink {
  uint64_t source = 0;  // sequence numbers; target < source
  uint64_t target = 0;
  LinkKind kind = LinkKind::kTracking;
  RegistrationResult result;  // T_target_source
};

struct Traverse {
  std::vector<TrajectoryPose> poses;         // by sequence number, from 0 without gaps
  std::vector<std::optional<Prior>> priors;  // same length: motion since the scan before, which is the target
  std::vector<TraverseLink> links;           // in the order in which they were found
  int num_segments = 0;                      // begun so far, and the number of the next: none is used again
  uint64_t version = 0;                      // of the trajectory: grows whenever poses that were told are revised
};

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_TRAJECTORY_H_
