// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/rigid_transform.h"

#include <cmath>

#include "core/base/small_matrices.h"

namespace curvereg {

Eigen::Matrix3d RotationFromVector(const Eigen::Vector3d& omega) {
  const double angle = omega.norm();
  if (angle < 1e-12) {
    const Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    return axes - axes.colwise().cross(omega);
  }
  return Eigen::AngleAxisd(angle, omega / angle).toRotationMatrix();
}

Eigen::Vector3d VectorFromRotation(const Eigen::Matrix3d& R) {
  Eigen::Quaterniond q(R);
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  const double sine = q.vec().norm();
  if (sine < 1e-12) return 2.0 * q.vec();
  return q.vec() * (2.0 * std::atan2(sine, q.w()) / sine);
}

RigidTransform TransformFromVector(const Vector6d& delta) {
  RigidTransform T = RigidTransform::Identity();
  T.linear() = RotationFromVector(delta.head<3>());
  T.translation() = delta.tail<3>();
  return T;
}

double RotationAngle(const RigidTransform& T) { return VectorFromRotation(T.linear()).norm(); }

TransformDifference Difference(const RigidTransform& T_a, const RigidTransform& T_b) {
  const RigidTransform T_a_b = T_a.inverse() * T_b;
  return {RotationAngle(T_a_b), T_a_b.translation().norm()};
}

bool IsRigid(const RigidTransform& T, double tolerance) {
  if (!T.matrix().allFinite()) return false;
  const Eigen::Matrix3d R = T.linear();
  const double orthogonality = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  return orthogonality <= tolerance && std::abs(R.determinant() - 1.0) <= tolerance;
}

RigidTransform Orthonormalised(const RigidTransform& T) {
  const SingularValues svd = SingularValuesOf(T.linear());
  Eigen::Vector3d signs(1.0, 1.0, (svd.U * svd.V.transpose()).determinant() < 0.0 ? -1.0 : 1.0);
  RigidTransform result = T;
  result.linear() = svd.U * signs.asDiagonal() * svd.V.transpose();
  return result;
}

}  // namespace curvereg
