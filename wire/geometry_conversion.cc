// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/geometry_conversion.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "wire/error.h"

namespace curvereg::wire {
namespace {

constexpr int kUpperTriangle = 21;  // numbers of a symmetric 6x6 matrix

}  // namespace

v1::RigidTransform ToWire(const RigidTransform& T) {
  v1::RigidTransform message;
  message.mutable_translation()->set_x(T.translation().x());
  message.mutable_translation()->set_y(T.translation().y());
  message.mutable_translation()->set_z(T.translation().z());
  Eigen::Quaterniond q(T.linear());
  q.normalize();
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();  // q and -q are the same rotation: always the one with w >= 0
  message.mutable_rotation()->set_x(q.x());
  message.mutable_rotation()->set_y(q.y());
  message.mutable_rotation()->set_z(q.z());
  message.mutable_rotation()->set_w(q.w());
  return message;
}

absl::StatusOr<RigidTransform> FromWire(const v1::RigidTransform& T) {
  // An absent part is not taken for zero: nothing stands for an identity that nobody gave.
  if (!T.has_translation()) return FieldError("translation", "missing");
  if (!T.has_rotation()) return FieldError("rotation", "missing");
  const Eigen::Vector3d translation(T.translation().x(), T.translation().y(), T.translation().z());
  if (!translation.allFinite()) return FieldError("translation", "not finite");
  const Eigen::Quaterniond rotation(T.rotation().w(), T.rotation().x(), T.rotation().y(), T.rotation().z());
  if (!(std::abs(rotation.norm() - 1.0) <= 0.01)) {
    return FieldError("rotation", "not a unit quaternion (its length must be within 1 percent of 1)");
  }
  RigidTransform result = RigidTransform::Identity();
  result.linear() = rotation.normalized().toRotationMatrix();
  result.translation() = translation;
  return result;
}

v1::PoseCovariance ToWire(const Matrix6d& covariance) {
  v1::PoseCovariance message;
  message.mutable_upper_triangle()->Reserve(kUpperTriangle);
  for (int row = 0; row < 6; ++row) {
    for (int col = row; col < 6; ++col) message.add_upper_triangle(covariance(row, col));
  }
  return message;
}

absl::StatusOr<Matrix6d> SymmetricFromWire(const v1::PoseCovariance& covariance) {
  if (covariance.upper_triangle_size() != kUpperTriangle) return FieldError("upper_triangle", "not 21 numbers");
  Matrix6d matrix;
  int next = 0;
  for (int row = 0; row < 6; ++row) {
    for (int col = row; col < 6; ++col) matrix(row, col) = matrix(col, row) = covariance.upper_triangle(next++);
  }
  if (!matrix.allFinite()) return FieldError("upper_triangle", "not finite");
  return matrix;
}

absl::StatusOr<Matrix6d> FromWire(const v1::PoseCovariance& covariance) {
  absl::StatusOr<Matrix6d> matrix = SymmetricFromWire(covariance);
  if (!matrix.ok()) return matrix.status();
  if (const Eigen::LLT<Matrix6d> cholesky(*matrix); cholesky.info() != Eigen::Success) {
    return FieldError("upper_triangle", "not positive definite");
  }
  return matrix;
}

}  // namespace curvereg::wire
