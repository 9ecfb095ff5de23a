// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Is the pose to be believed? Measures that do not depend on the sensor's scale decide: agreement of free space both
// ways, correlation of the band-passed views, how much of the overlapping surface fits within its own roughness, and the
// distance to the next best pose.
#ifndef CURVEREG_CORE_VERDICT_H_
#define CURVEREG_CORE_VERDICT_H_

#include "core/prepared_scan.h"
#include "core/refinement.h"
#include "core/registration_result.h"

namespace curvereg {

// What the two scans say about one pose.
struct PoseCheck {
  double free_space_agreement = 0.0;  // the smaller of both ways, [0, 1]
  double overlap_source = 0.0;        // share of the source that the target saw, [0, 1]
  double overlap_target = 0.0;
  double overlap_points = 0.0;        // number of elements in the smaller overlap
};
PoseCheck CheckPose(const PreparedScan& source, const PreparedScan& target, const RigidTransform& T_target_source);

// Correlation of two band-passed views of one kind under a pose, over the pixels where both saw ground.
struct ViewCorrelation {
  double ncc = 0.0;    // [-1, 1]
  int num_pixels = 0;  // compared
};
ViewCorrelation CorrelateViews(const ViewFeatures& source, const ViewFeatures& target,
                               const RigidTransform& T_target_source);

}  // namespace curvereg

#endif  // CURVEREG_CORE_VERDICT_H_
