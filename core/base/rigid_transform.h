// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Rigid transforms. T_target_source maps source coordinates to target coordinates: p_target = T_target_source *
// p_source. Tangent vectors are ordered (rotation [rad], translation [m]) and act from the left: T' = Exp(delta) * T,
// so delta is expressed in the target frame.
#ifndef CURVEREG_CORE_BASE_RIGID_TRANSFORM_H_
#define CURVEREG_CORE_BASE_RIGID_TRANSFORM_H_

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace curvereg {

using RigidTransform = Eigen::Isometry3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

// Rotation matrix of the rotation vector `omega` [rad] (Rodrigues); exact to rounding for any length, also zero.
Eigen::Matrix3d RotationFromVector(const Eigen::Vector3d& omega);

// Rotation vector [rad], length in [0, pi], of the rotation matrix `R`.
Eigen::Vector3d VectorFromRotation(const Eigen::Matrix3d& R);

// The transform with rotation Exp(delta.head<3>()) and translation delta.tail<3>() (SO(3) x R^3, not SE(3)'s
// exponential).
RigidTransform TransformFromVector(const Vector6d& delta);

// Angle [rad] in [0, pi] of the rotation part of `T`.
double RotationAngle(const RigidTransform& T);

// Rotation angle [rad] and translation length [m] of T_a^-1 * T_b.
struct TransformDifference {
  double rotation_rad = 0.0;
  double translation_m = 0.0;
};
TransformDifference Difference(const RigidTransform& T_a, const RigidTransform& T_b);

// True when every entry is finite and the rotation part is orthonormal with determinant +1, each within `tolerance`.
bool IsRigid(const RigidTransform& T, double tolerance = 1e-6);

// The nearest rigid transform: orthonormalises the rotation part (SVD). Precondition: entries are finite.
RigidTransform Orthonormalised(const RigidTransform& T);

}  // namespace curvereg

#endif  // CURVEREG_CORE_BASE_RIGID_TRANSFORM_H_
