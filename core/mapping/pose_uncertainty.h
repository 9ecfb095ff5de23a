// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Uncertainty of chained transforms. A transform with its covariance is a Prior: (rotation [rad], translation [m]),
// left perturbation, target frame; without a covariance nothing is known of its error. First order throughout. [T. D.
// Barfoot, P. T. Furgale, "Associating Uncertainty With Three-Dimensional Poses", IEEE T-RO 30(3), 2014]
#ifndef CURVEREG_CORE_MAPPING_POSE_UNCERTAINTY_H_
#define CURVEREG_CORE_MAPPING_POSE_UNCERTAINTY_H_

#include <optional>

#include "core/mapping/pose_graph.h"
#include "core/mapping/trajectory.h"
#include "core/methods/registration_options.h"

namespace curvereg {

// T_a_c of T_a_b and T_b_c whose errors are independent; its covariance is unknown when either is.
Prior Chained(const Prior& T_a_b, const Prior& T_b_c);

// The source's position in the target frame is uncertain by rotation and translation together: 3 x 3, [m^2].
Eigen::Matrix3d PositionCovariance(const RigidTransform& T_target_source, const Matrix6d& covariance);

// T_target_source of two poses of one segment, in either order. Poses near in sequence share most of their error, so
// what they differ by is what came between; those far apart are taken for independent, which is too wide rather than
// too narrow. The least standard deviations are added, because
// the covariances of poses cover noise alone.
struct RelativePoseOptions {
  int shared_gap = 10;  // sequence numbers up to which poses count as near
  double least_sigma_rad = 0.02;
  double least_sigma_m = 0.2;
};
Prior RelativePose(const TrajectoryPose& target, const TrajectoryPose& source, const RelativePoseOptions& options = {});

// The covariance that a traverse uses for an accepted registration: its own (zero if it has none) plus the least
// variances of `options`, whose standard deviations grow with the distance of the two scans, as the measured errors do.
// Precondition: the result has a pose.
Matrix6d LinkCovariance(const RegistrationResult& result, const PoseGraphOptions& options);

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_POSE_UNCERTAINTY_H_
