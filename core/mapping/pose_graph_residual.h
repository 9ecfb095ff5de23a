// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// How far two poses of a pose graph are from what was measured between them, in standard deviations.
//
// Derivatives are by moves (omega [rad], v [m]) of a node about its own origin: R' = Exp(omega) R, t' = t + v. A left
// perturbation turns it about the frame's origin; PerturbationToMove and CovarianceAboutGraph change over.
#ifndef CURVEREG_CORE_MAPPING_POSE_GRAPH_RESIDUAL_H_
#define CURVEREG_CORE_MAPPING_POSE_GRAPH_RESIDUAL_H_

#include <Eigen/Core>

#include "core/base/rigid_transform.h"
#include "core/mapping/pose_graph.h"

namespace curvereg {

// W such that W e has covariance I when e has `covariance`; in no direction is the standard deviation below the
// floors of `options`. Precondition: `covariance` is positive definite.
Matrix6d Whitening(const Matrix6d& covariance, const PoseGraphOptions& options);

// [v]x: [v]x w = v x w.
Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& v);

// A: Exp(A delta) T = T Exp(delta) to first order.
Matrix6d Adjoint(const RigidTransform& T);

// A C A^T: the covariance C, left perturbation, of a transform to the source frame as that of the same one carried on
// to the target frame. Symmetric to the bit.
Matrix6d TransportedCovariance(const Matrix6d& covariance, const RigidTransform& T_target_source);

// The covariance, left perturbation, of the inverse of a transform that has `covariance`.
Matrix6d InverseCovariance(const RigidTransform& T, const Matrix6d& covariance);

// e = Log(T_target_source (T_graph_target^-1 T_graph_source)^-1), rotation vector and translation, target frame: the
// left perturbation that makes the measured transform out of the one that follows from the poses.
Vector6d EdgeError(const RigidTransform& T_target_source, const RigidTransform& T_graph_source,
                   const RigidTransform& T_graph_target);

// Derivatives of EdgeError by the moves of its two nodes. Those of the rotation grow without bound as the error nears
// half a turn.
struct EdgeDerivatives {
  Matrix6d by_source;
  Matrix6d by_target;
};
EdgeDerivatives DifferentiateEdge(const RigidTransform& T_target_source, const RigidTransform& T_graph_source,
                                  const RigidTransform& T_graph_target);

// B: (omega, v) = B delta is the move that the left perturbation `delta` makes, to first order.
Matrix6d PerturbationToMove(const RigidTransform& T_graph_node);

// The covariance of a pose as a left perturbation, given that of its moves.
Matrix6d CovarianceAboutGraph(const RigidTransform& T_graph_node, const Matrix6d& covariance_of_moves);

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_POSE_GRAPH_RESIDUAL_H_
