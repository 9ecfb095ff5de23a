// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// All accepted links and odometry of a traverse made into one trajectory.
#ifndef CURVEREG_CORE_MAPPING_REVISE_TRAVERSE_H_
#define CURVEREG_CORE_MAPPING_REVISE_TRAVERSE_H_

#include <vector>

#include "absl/status/statusor.h"
#include "core/base/rigid_transform.h"
#include "core/base/stop.h"
#include "core/mapping/tracking_options.h"
#include "core/mapping/trajectory.h"

namespace curvereg {

struct SegmentJoin {
  int segment = 0;         // remains
  int joined_segment = 0;  // ended; its poses move over
  RigidTransform T_segment_joined = RigidTransform::Identity();
};

// The trajectory that agrees best with all accepted links and priors (OptimizePoseGraph). A pose is kRegistered when
// links that were not rejected connect it with an earlier one, by whichever way, kPrior when odometry alone does.
// Segments are joined, never split: a part that is connected by one link is placed by that link, because nothing
// contradicts it. Of links that contradict each other usually one is kept. If all of them are rejected, the part stays
// near where they place it, and its covariance, of a thousand times their standard deviations, marks it as unknown.
struct TraverseRevision {
  std::vector<SegmentJoin> joins;         // segments that accepted links connect
  std::vector<TrajectoryPose> poses;      // those that changed, by sequence number
  int num_links = 0;                      // used
  int num_rejected_links = 0;             // accepted by registration, rejected here
  double max_translation_change_m = 0.0;  // of poses that stayed in their segment
  bool converged = true;                  // false: the poses still moved when max_iterations was reached
};
absl::StatusOr<TraverseRevision> ReviseTraverse(const Traverse& traverse, const TrackingOptions& options,
                                                const Stop& stop = {});

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_REVISE_TRAVERSE_H_
