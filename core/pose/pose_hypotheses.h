// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// From two bird's-eye views to full poses: the planar consensus gives yaw and shift, the levelling rotations roll and
// pitch, and the height comes from the matched features (elevation) or from sliding one occupancy over the other.
#ifndef CURVEREG_CORE_POSE_POSE_HYPOTHESES_H_
#define CURVEREG_CORE_POSE_POSE_HYPOTHESES_H_

#include <vector>

#include "core/base/rigid_transform.h"
#include "core/features/view_features.h"
#include "core/pose/consensus.h"

namespace curvereg {

struct PoseHypothesis {
  RigidTransform T_target_source = RigidTransform::Identity();
  int num_inliers = 0;  // matches that agree; 0 for a prior or identity
};

struct HypothesesFromViews {
  std::vector<PoseHypothesis> hypotheses;  // most inliers first
  int num_matches = 0;
};

// Precondition: both views are of the same kind.
HypothesesFromViews FindPoseHypotheses(const ViewFeatures& source, const ViewFeatures& target,
                                       const ConsensusOptions& options);

}  // namespace curvereg

#endif  // CURVEREG_CORE_POSE_POSE_HYPOTHESES_H_
