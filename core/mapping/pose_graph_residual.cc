// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/pose_graph_residual.h"

#include <cmath>

#include "core/base/small_matrices.h"

namespace curvereg {
namespace {

// J: Log(Exp(phi) Exp(delta)) = phi + J delta to first order.
Eigen::Matrix3d LogDerivative(const Eigen::Vector3d& phi) {
  const double angle = phi.norm();
  // The limit is 1/12; below 1e-4 rad the difference of the two large terms would be noise.
  const double square_term = angle < 1e-4 ? 1.0 / 12.0 : (1.0 - 0.5 * angle / std::tan(0.5 * angle)) / (angle * angle);
  const Eigen::Matrix3d cross = CrossMatrix(phi);
  return Eigen::Matrix3d::Identity() + 0.5 * cross + square_term * cross * cross;
}

}  // namespace

Matrix6d Whitening(const Matrix6d& covariance, const PoseGraphOptions& options) {
  Vector6d unit;
  unit << Eigen::Vector3d::Constant(options.least_sigma_rad), Eigen::Vector3d::Constant(options.least_sigma_m);
  const Matrix6d in_units = unit.cwiseInverse().asDiagonal() * covariance * unit.cwiseInverse().asDiagonal();
  const SymmetricEigen<6> eigen = EigenOf(Matrix6d(0.5 * (in_units + in_units.transpose())));
  const Vector6d sigmas = eigen.values.cwiseMax(1.0).cwiseSqrt();
  return sigmas.cwiseInverse().asDiagonal() * eigen.vectors.transpose() * unit.cwiseInverse().asDiagonal();
}

Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return matrix;
}

Matrix6d Adjoint(const RigidTransform& T) {
  Matrix6d adjoint = Matrix6d::Zero();
  adjoint.topLeftCorner<3, 3>() = T.linear();
  adjoint.bottomRightCorner<3, 3>() = T.linear();
  adjoint.bottomLeftCorner<3, 3>() = CrossMatrix(T.translation()) * T.linear();
  return adjoint;
}

Matrix6d TransportedCovariance(const Matrix6d& covariance, const RigidTransform& T_target_source) {
  const Matrix6d adjoint = Adjoint(T_target_source);
  const Matrix6d moved = adjoint * covariance * adjoint.transpose();
  return 0.5 * (moved + moved.transpose());
}

Matrix6d InverseCovariance(const RigidTransform& T, const Matrix6d& covariance) {
  return TransportedCovariance(covariance, T.inverse());
}

Vector6d EdgeError(const RigidTransform& T_target_source, const RigidTransform& T_graph_source,
                   const RigidTransform& T_graph_target) {
  const RigidTransform error = T_target_source * T_graph_source.inverse() * T_graph_target;
  Vector6d e;
  e << VectorFromRotation(error.linear()), error.translation();
  return e;
}

EdgeDerivatives DifferentiateEdge(const RigidTransform& T_target_source, const RigidTransform& T_graph_source,
                                  const RigidTransform& T_graph_target) {
  const Eigen::Matrix3d R_target_graph = T_target_source.linear() * T_graph_source.linear().transpose();
  const Eigen::Vector3d phi = VectorFromRotation(R_target_graph * T_graph_target.linear());
  const Eigen::Matrix3d turn = LogDerivative(phi) * T_graph_target.linear().transpose();
  const Eigen::Vector3d arm = T_graph_target.translation() - T_graph_source.translation();
  EdgeDerivatives derivatives{Matrix6d::Zero(), Matrix6d::Zero()};
  derivatives.by_source.topLeftCorner<3, 3>() = -turn;
  derivatives.by_source.bottomLeftCorner<3, 3>() = R_target_graph * CrossMatrix(arm);
  derivatives.by_source.bottomRightCorner<3, 3>() = -R_target_graph;
  derivatives.by_target.topLeftCorner<3, 3>() = turn;
  derivatives.by_target.bottomRightCorner<3, 3>() = R_target_graph;
  return derivatives;
}

Matrix6d PerturbationToMove(const RigidTransform& T_graph_node) {
  // t' = Exp(omega) t + u = t + v: v = u - t x omega.
  Matrix6d change = Matrix6d::Identity();
  change.bottomLeftCorner<3, 3>() = -CrossMatrix(T_graph_node.translation());
  return change;
}

Matrix6d CovarianceAboutGraph(const RigidTransform& T_graph_node, const Matrix6d& covariance_of_moves) {
  Matrix6d change = Matrix6d::Identity();
  change.bottomLeftCorner<3, 3>() = CrossMatrix(T_graph_node.translation());
  return change * covariance_of_moves * change.transpose();
}

}  // namespace curvereg
