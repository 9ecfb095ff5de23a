// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/small_matrices.h"

#include <cmath>

#include <gtest/gtest.h>

namespace curvereg {
namespace {

Eigen::Matrix3d Turn() {
  return Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, -2.0, 0.5).normalized()).toRotationMatrix();
}

// Symmetric, positive definite, with off-diagonal entries.
Matrix6d Sample6() {
  Matrix6d A = Matrix6d::Identity();
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) A(i, j) += 1.0 / (1.0 + std::abs(i - j)) + (i == j ? i : 0.0);
  }
  return A;
}

TEST(SmallMatricesTest, EigenvaluesAscendAndVectorsBelongToThem) {
  const Eigen::Matrix3d A = Turn() * Eigen::Vector3d(5.0, -1.0, 2.0).asDiagonal() * Turn().transpose();
  const SymmetricEigen<3> eigen = EigenOf(A);
  EXPECT_TRUE(eigen.values.isApprox(Eigen::Vector3d(-1.0, 2.0, 5.0), 1e-12));
  EXPECT_TRUE((A * eigen.vectors).isApprox(eigen.vectors * eigen.values.asDiagonal(), 1e-12));
  EXPECT_NEAR(std::abs(eigen.vectors.col(2).dot(Turn().col(0))), 1.0, 1e-12);
  EXPECT_TRUE(EigenvaluesOf(A).isApprox(eigen.values, 1e-12));
}

TEST(SmallMatricesTest, SixEigenvectorsDiagonalise) {
  const SymmetricEigen<6> eigen = EigenOf(Sample6());
  EXPECT_TRUE((eigen.vectors * eigen.values.asDiagonal() * eigen.vectors.transpose()).isApprox(Sample6(), 1e-12));
  for (int i = 1; i < 6; ++i) EXPECT_LE(eigen.values[i - 1], eigen.values[i]);
}

TEST(SmallMatricesTest, SolvesSymmetricSystems) {
  Eigen::Matrix3d A;
  A << 4.0, 1.0, 0.0, 1.0, 3.0, 1.0, 0.0, 1.0, 2.0;
  EXPECT_TRUE(SolveSymmetric(A, A * Eigen::Vector3d(1.0, -2.0, 3.0)).isApprox(Eigen::Vector3d(1.0, -2.0, 3.0), 1e-12));
  Vector6d x;
  x << 1.0, 2.0, -3.0, 4.0, -5.0, 6.0;
  EXPECT_TRUE(SolveSymmetric(Sample6(), Vector6d(Sample6() * x)).isApprox(x, 1e-12));
  EXPECT_TRUE((InverseOfSymmetric(Sample6()) * Sample6()).isIdentity(1e-12));
}

TEST(SmallMatricesTest, MahalanobisDistanceCountsInSigmas) {
  Vector6d variances;
  variances << 1.0, 4.0, 9.0, 16.0, 25.0, 36.0;
  Vector6d e;
  e << 1.0, 2.0, 3.0, 0.0, 0.0, 12.0;  // 1, 1, 1, 0, 0 and 2 sigma
  EXPECT_NEAR(SquaredMahalanobisDistance(e, variances.asDiagonal()), 7.0, 1e-12);
}

TEST(SmallMatricesTest, SingularValuesRebuildTheMatrix) {
  Eigen::Matrix3d M;
  M << 1.0, 2.0, 3.0, 0.0, 1.0, 4.0, 5.0, 6.0, 0.0;
  const SingularValues svd = SingularValuesOf(M);
  EXPECT_TRUE((svd.U * svd.values.asDiagonal() * svd.V.transpose()).isApprox(M, 1e-12));
  EXPECT_TRUE((svd.U.transpose() * svd.U).isIdentity(1e-12));
  EXPECT_TRUE((svd.V.transpose() * svd.V).isIdentity(1e-12));
  EXPECT_GE(svd.values[0], svd.values[1]);
  EXPECT_GE(svd.values[2], 0.0);
  EXPECT_NEAR(svd.values.prod(), std::abs(M.determinant()), 1e-9);
}

TEST(SmallMatricesTest, RotationBetweenTurnsOneDirectionOntoTheOther) {
  const Eigen::Vector3d from(0.3, -0.2, 0.9);
  const Eigen::Matrix3d R = RotationBetween(from, Eigen::Vector3d::UnitZ());
  EXPECT_TRUE((R * from.normalized()).isApprox(Eigen::Vector3d::UnitZ(), 1e-12));
  EXPECT_NEAR(R.determinant(), 1.0, 1e-12);
  // About the shortest arc: the axis normal to both stays.
  const Eigen::Vector3d axis = from.cross(Eigen::Vector3d::UnitZ()).normalized();
  EXPECT_TRUE((R * axis).isApprox(axis, 1e-12));
  const Eigen::Matrix3d opposite = RotationBetween(-Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitZ());
  EXPECT_TRUE((opposite * -Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d::UnitZ(), 1e-12));
}

}  // namespace
}  // namespace curvereg
