// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The covariances of the poses of a pose graph: diagonal blocks of the inverse of its information matrix. Only those
// entries of the inverse are computed that lie where the matrix's Cholesky factor has any, for the others do not enter
// [K. Takahashi, J. Fagan, M. Chin, "Formation of a sparse bus impedance matrix", 8th PICA conference, 1973].
#ifndef CURVEREG_CORE_MAPPING_POSE_GRAPH_COVARIANCE_H_
#define CURVEREG_CORE_MAPPING_POSE_GRAPH_COVARIANCE_H_

#include <Eigen/SparseCore>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/rigid_transform.h"
#include "core/base/stop.h"

namespace curvereg {

// The 6x6 blocks on the diagonal of information^-1. `information`: symmetric, lower triangle enough, size 6 n, each
// block on the diagonal fully stored (zeros too). Deterministic, one thread; time as of a few factorisations.
// FAILED_PRECONDITION: not positive definite; CANCELLED; DEADLINE_EXCEEDED.
absl::StatusOr<std::vector<Matrix6d>> DiagonalBlocksOfInverse(const Eigen::SparseMatrix<double>& information,
                                                              const Stop& stop = {});

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_POSE_GRAPH_COVARIANCE_H_
