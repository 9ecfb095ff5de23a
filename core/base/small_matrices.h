// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Decompositions of 3x3 and 6x6 matrices, as Eigen computes them. Compiled once, here: each costs seconds of
// compilation wherever Eigen's template is called directly.
#ifndef CURVEREG_CORE_BASE_SMALL_MATRICES_H_
#define CURVEREG_CORE_BASE_SMALL_MATRICES_H_

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/base/rigid_transform.h"

namespace curvereg {

// Of a symmetric matrix: eigenvalues in ascending order, and the unit eigenvector of each as a column. Only the lower
// triangle is read. Eigenvalues of a matrix that is not finite are not finite.
template <int N>
struct SymmetricEigen {
  Eigen::Matrix<double, N, 1> values;
  Eigen::Matrix<double, N, N> vectors;
};
SymmetricEigen<3> EigenOf(const Eigen::Matrix3d& symmetric);
SymmetricEigen<6> EigenOf(const Matrix6d& symmetric);
Eigen::Vector3d EigenvaluesOf(const Eigen::Matrix3d& symmetric);

// x of A x = b, for a symmetric positive semi-definite A (LDL^T with pivoting).
Eigen::Vector3d SolveSymmetric(const Eigen::Matrix3d& A, const Eigen::Vector3d& b);
Vector6d SolveSymmetric(const Matrix6d& A, const Vector6d& b);
Matrix6d InverseOfSymmetric(const Matrix6d& A);

// e^T C^-1 e of a positive definite covariance C (Cholesky); not finite where C is singular.
double SquaredMahalanobisDistance(const Vector6d& e, const Matrix6d& covariance);

// M = U diag(values) V^T, values descending and not negative; U and V orthogonal.
struct SingularValues {
  Eigen::Matrix3d U;
  Eigen::Vector3d values;
  Eigen::Matrix3d V;
};
SingularValues SingularValuesOf(const Eigen::Matrix3d& M);

// The rotation about the shortest arc that turns direction `from` onto direction `to`; about any axis normal to them
// where they are opposite. Precondition: neither is zero.
Eigen::Matrix3d RotationBetween(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace curvereg

#endif  // CURVEREG_CORE_BASE_SMALL_MATRICES_H_
