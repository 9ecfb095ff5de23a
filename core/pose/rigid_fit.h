// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The rigid transform that aligns corresponding points with the least sum of squared distances, in closed
// form: K. S. Arun, T. S. Huang, S. D. Blostein, "Least-squares fitting of two 3-D point sets", PAMI 9(5), 1987, with
// the sign correction of S. Umeyama, PAMI 13(4), 1991, eq. (40), so that the answer is never a reflection. No scale.
#ifndef CURVEREG_CORE_POSE_RIGID_FIT_H_
#define CURVEREG_CORE_POSE_RIGID_FIT_H_

#include <Eigen/Core>
#include <span>

#include "absl/status/statusor.h"
#include "core/base/rigid_transform.h"

namespace curvereg {

// One place, seen in the source and in the target frame [m].
struct PointPair {
  Eigen::Vector3d source = Eigen::Vector3d::Zero();
  Eigen::Vector3d target = Eigen::Vector3d::Zero();
};

// T_target_source of the least sum of |T_target_source * source - target|^2. Exact pairs are fitted to about 1e-13 of
// the coordinates' size over the points' spread. O(pairs).
// INVALID_ARGUMENT: fewer than three pairs, a coordinate that is not finite. FAILED_PRECONDITION: the points of one
// side are equal or on one line, to 1e-9 of their spread, so that the rotation is not determined.
absl::StatusOr<RigidTransform> FitRigidTransform(std::span<const PointPair> pairs);

}  // namespace curvereg

#endif  // CURVEREG_CORE_POSE_RIGID_FIT_H_
