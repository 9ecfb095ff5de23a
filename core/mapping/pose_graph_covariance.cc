// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/pose_graph_covariance.h"

#include <Eigen/SparseCholesky>
#include <cassert>

#include "core/base/stop_status.h"

namespace curvereg {
namespace {

using Sparse = Eigen::SparseMatrix<double>;  // column by column, rows ascending

// Z = (L D L^T)^-1, as far as L, unit lower triangular, has entries.
struct SelectedInverse {
  Sparse below;  // the diagonal, where L has entries
  Eigen::VectorXd diagonal;
};

struct Scratch {
  std::vector<int> place;   // of a row in the column at work; -1: none
  std::vector<double> sum;  // by place
};

// Column j from those behind it: Z_ij = -sum_k Z_ik L_kj and Z_jj = 1 / D_j - sum_k L_kj Z_kj. All Z_ik needed are
// there, for the rows that a column of L has entries in are connected with each other. `Z.below` holds L_j as it comes
// in.
void InvertColumn(int j, double D_j, SelectedInverse& Z, Scratch& scratch) {
  const int begin = Z.below.outerIndexPtr()[j];
  const int size = Z.below.outerIndexPtr()[j + 1] - begin;
  const int* const row = Z.below.innerIndexPtr() + begin;
  double* const l = Z.below.valuePtr() + begin;
  scratch.sum.assign(static_cast<size_t>(size), 0.0);
  double* const sum = scratch.sum.data();
  for (int b = 0; b < size; ++b) scratch.place[static_cast<size_t>(row[b])] = b;
  for (int b = 0; b < size; ++b) {
    sum[b] += Z.diagonal[row[b]] * l[b];
    for (Sparse::InnerIterator z(Z.below, row[b]); z; ++z) {
      const int a = scratch.place[static_cast<size_t>(z.row())];
      if (a < 0) continue;
      sum[a] += z.value() * l[b];
      sum[b] += z.value() * l[a];
    }
  }
  Z.diagonal[j] = 1.0 / D_j;
  for (int b = 0; b < size; ++b) {
    scratch.place[static_cast<size_t>(row[b])] = -1;
    Z.diagonal[j] += l[b] * sum[b];
    l[b] = -sum[b];
  }
}

double Entry(const SelectedInverse& Z, int row, int column) {
  if (row == column) return Z.diagonal[row];
  return Z.below.coeff(std::max(row, column), std::min(row, column));
}

}  // namespace

absl::StatusOr<std::vector<Matrix6d>> DiagonalBlocksOfInverse(const Sparse& information, const Stop& stop) {
  assert(information.rows() == information.cols() && information.rows() % 6 == 0);
  if (information.rows() == 0) return std::vector<Matrix6d>();
  const Eigen::SimplicialLDLT<Sparse> factor(information);
  const auto size = static_cast<int>(information.rows());
  if (factor.info() != Eigen::Success || !(factor.vectorD().array() > 0.0).all())
    return absl::FailedPreconditionError("the poses are not determined by the edges");
  SelectedInverse Z{factor.matrixL().nestedExpression(), Eigen::VectorXd::Zero(size)};
  Scratch scratch{std::vector<int>(static_cast<size_t>(size), -1), {}};
  for (int j = size - 1; j >= 0; --j) {
    if (j % 64 == 0) {
      if (absl::Status status = StopStatus(stop, "the optimisation"); !status.ok()) return status;
    }
    InvertColumn(j, factor.vectorD()[j], Z, scratch);
  }
  const Eigen::VectorXi& place = factor.permutationP().indices();
  std::vector<Matrix6d> blocks(static_cast<size_t>(size) / 6);
  for (int node = 0; node < size / 6; ++node)
    for (int row = 0; row < 6; ++row)
      for (int column = 0; column < 6; ++column)
        blocks[static_cast<size_t>(node)](row, column) = Entry(Z, place[6 * node + row], place[6 * node + column]);
  return blocks;
}

}  // namespace curvereg
