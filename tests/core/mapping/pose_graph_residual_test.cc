// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/pose_graph_residual.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/testing/matchers.h"
#include "tests/testing/pose_graphs.h"

namespace curvereg {
namespace {

using testing::DiagonalCovariance;
using testing::IsNear;
using testing::NormalVector;
using testing::RandomCovariance;

RigidTransform RandomTransform(sim::RandomStream& random) {
  Vector6d vector = NormalVector(random);
  vector.tail<3>() *= 10.0;
  return TransformFromVector(vector);
}

// The pose after the move (omega, v).
RigidTransform Moved(const RigidTransform& T_graph_node, const Vector6d& move) {
  RigidTransform moved = T_graph_node;
  moved.linear() = RotationFromVector(move.head<3>()) * T_graph_node.linear();
  moved.translation() += move.tail<3>();
  return moved;
}

TEST(Whitening, DividesByStandardDeviations) {
  const Matrix6d W = Whitening(DiagonalCovariance(0.01, 0.5), {});
  const Vector6d e = (Vector6d() << 0.01, 0.02, 0.0, 0.5, 0.0, 0.0).finished();
  EXPECT_NEAR((W * e).squaredNorm(), 1.0 + 4.0 + 1.0, 1e-9);
}

TEST(Whitening, UndoesCorrelation) {
  sim::RandomStream random(1);
  for (int i = 0; i < 20; ++i) {
    const Matrix6d covariance = RandomCovariance(random, 0.01, 0.1);
    const Matrix6d W = Whitening(covariance, {});
    EXPECT_LT((W * covariance * W.transpose() - Matrix6d::Identity()).cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST(Whitening, BelievesNoLessThanTheLeastDeviations) {
  const PoseGraphOptions options{.least_sigma_rad = 1e-3, .least_sigma_m = 1e-2};
  const Matrix6d W = Whitening(DiagonalCovariance(1e-9, 1e-9), options);
  const Matrix6d W_at_floor = Whitening(DiagonalCovariance(1e-3, 1e-2), options);
  EXPECT_LT((W.transpose() * W - W_at_floor.transpose() * W_at_floor).norm(), 1e-6 * W_at_floor.squaredNorm());
}

TEST(Adjoint, CarriesAPerturbationToTheOtherSide) {
  sim::RandomStream random(2);
  const RigidTransform T = RandomTransform(random);
  const Vector6d delta = 1e-6 * NormalVector(random);
  const RigidTransform left = TransformFromVector(Adjoint(T) * delta) * T;
  EXPECT_THAT(T * TransformFromVector(delta), IsNear(left, 1e-9, 1e-9));
}

TEST(CrossMatrix, IsTheCrossProduct) {
  const Eigen::Vector3d v(1.0, -2.0, 3.0);
  const Eigen::Vector3d w(0.5, 4.0, -1.0);
  EXPECT_EQ(CrossMatrix(v) * w, v.cross(w));
}

TEST(InverseCovariance, OfTheInverseIsTheFirst) {
  sim::RandomStream random(3);
  const RigidTransform T = RandomTransform(random);
  const Matrix6d covariance = RandomCovariance(random, 0.01, 0.1);
  const Matrix6d back = InverseCovariance(T.inverse(), InverseCovariance(T, covariance));
  EXPECT_LT((back - covariance).norm(), 1e-12);
  // 1 mrad about z at the far end of 10 m along x is 1 cm along y.
  RigidTransform T_far = RigidTransform::Identity();
  T_far.translation().x() = -10.0;
  EXPECT_NEAR(InverseCovariance(T_far, DiagonalCovariance(1e-3, 1e-9))(4, 4), 1e-4, 1e-9);
}

TEST(EdgeError, IsThePerturbationOfTheMeasurement) {
  sim::RandomStream random(4);
  const RigidTransform T_graph_source = RandomTransform(random), T_graph_target = RandomTransform(random);
  const RigidTransform T_target_source = T_graph_target.inverse() * T_graph_source;
  EXPECT_LT(EdgeError(T_target_source, T_graph_source, T_graph_target).norm(), 1e-12);
  const Vector6d error = (Vector6d() << 0.3, -0.2, 0.1, 1.0, 2.0, -3.0).finished();
  const Vector6d found = EdgeError(TransformFromVector(error) * T_target_source, T_graph_source, T_graph_target);
  EXPECT_LT((found - error).norm(), 1e-12);
}

// Central differences, for errors from none to nearly half a turn.
TEST(DifferentiateEdge, AgreesWithDifferences) {
  sim::RandomStream random(5);
  constexpr double kStep = 1e-6;
  for (const double turn : {0.0, 1e-5, 0.1, 1.5, 3.0}) {
    const RigidTransform T_graph_source = RandomTransform(random), T_graph_target = RandomTransform(random);
    Vector6d error = Vector6d::Zero();
    error.head<3>() = turn * NormalVector(random).head<3>().normalized();
    const RigidTransform T_target_source = TransformFromVector(error) * T_graph_target.inverse() * T_graph_source;
    const EdgeDerivatives derivatives = DifferentiateEdge(T_target_source, T_graph_source, T_graph_target);
    for (int i = 0; i < 6; ++i) {
      const Vector6d step = kStep * Vector6d::Unit(i);
      const Vector6d by_source = (EdgeError(T_target_source, Moved(T_graph_source, step), T_graph_target) -
                                  EdgeError(T_target_source, Moved(T_graph_source, -step), T_graph_target)) /
                                 (2.0 * kStep);
      const Vector6d by_target = (EdgeError(T_target_source, T_graph_source, Moved(T_graph_target, step)) -
                                  EdgeError(T_target_source, T_graph_source, Moved(T_graph_target, -step))) /
                                 (2.0 * kStep);
      EXPECT_LT((derivatives.by_source.col(i) - by_source).norm(), 1e-6) << "turn " << turn << ", column " << i;
      EXPECT_LT((derivatives.by_target.col(i) - by_target).norm(), 1e-6) << "turn " << turn << ", column " << i;
    }
  }
}

TEST(PerturbationToMove, GivesTheMoveThatItMakes) {
  sim::RandomStream random(7);
  const RigidTransform T = RandomTransform(random);
  const Vector6d delta = 1e-6 * NormalVector(random);
  EXPECT_THAT(Moved(T, PerturbationToMove(T) * delta), IsNear(TransformFromVector(delta) * T, 1e-9, 1e-9));
}

TEST(CovarianceAboutGraph, IsThatOfTheLeftPerturbation) {
  sim::RandomStream random(6);
  const RigidTransform T = RandomTransform(random);
  // Moves as columns: with covariance M M^T their perturbations must have N N^T.
  Matrix6d moves, perturbations;
  for (int i = 0; i < 6; ++i) {
    moves.col(i) = 1e-6 * NormalVector(random);
    const RigidTransform change = Moved(T, moves.col(i)) * T.inverse();
    perturbations.col(i) << VectorFromRotation(change.linear()), change.translation();
  }
  const Matrix6d expected = perturbations * perturbations.transpose();
  EXPECT_LT((CovarianceAboutGraph(T, moves * moves.transpose()) - expected).norm(), 1e-4 * expected.norm());
}

}  // namespace
}  // namespace curvereg
