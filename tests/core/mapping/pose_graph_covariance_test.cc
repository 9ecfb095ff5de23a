// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/pose_graph_covariance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <chrono>
#include <stop_token>
#include <utility>
#include <vector>

#include "tests/testing/matchers.h"
#include "tests/testing/pose_graphs.h"

namespace curvereg {
namespace {

using testing::HasCode;
using testing::IsOk;

// J^T J of random 6 x 12 blocks that join the pairs of nodes; `own` times the identity keeps it definite.
Eigen::SparseMatrix<double> Information(int num_nodes, const std::vector<std::pair<int, int>>& pairs, double own) {
  sim::RandomStream random(7);
  Eigen::MatrixXd dense = own * Eigen::MatrixXd::Identity(6 * num_nodes, 6 * num_nodes);
  for (const auto& [a, b] : pairs) {
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6, 6 * num_nodes);
    for (int i = 0; i < 6; ++i) {
      J.col(6 * a + i) = testing::NormalVector(random);
      J.col(6 * b + i) = testing::NormalVector(random);
    }
    dense += J.transpose() * J;
  }
  return dense.sparseView();
}

void ExpectBlocksOfDenseInverse(const Eigen::SparseMatrix<double>& information) {
  const auto blocks = DiagonalBlocksOfInverse(information);
  ASSERT_THAT(blocks, IsOk());
  const Eigen::MatrixXd inverse = Eigen::MatrixXd(information).inverse();
  ASSERT_EQ(static_cast<Eigen::Index>(blocks->size()), information.rows() / 6);
  for (size_t i = 0; i < blocks->size(); ++i) {
    const Matrix6d expected = inverse.block<6, 6>(static_cast<Eigen::Index>(6 * i), static_cast<Eigen::Index>(6 * i));
    EXPECT_LT(((*blocks)[i] - expected).norm(), 1e-9 * expected.norm()) << "block " << i;
  }
}

TEST(DiagonalBlocksOfInverse, AreThoseOfTheDenseInverse) {
  std::vector<std::pair<int, int>> pairs;
  for (int i = 1; i < 30; ++i) pairs.emplace_back(i, i - 1);
  ExpectBlocksOfDenseInverse(Information(30, pairs, 0.1));
  pairs.insert(pairs.end(), {{29, 0}, {20, 3}, {15, 4}, {25, 11}, {7, 28}, {13, 2}});  // fill-in
  ExpectBlocksOfDenseInverse(Information(30, pairs, 0.1));
}

TEST(DiagonalBlocksOfInverse, OfASingleBlockIsItsInverse) { ExpectBlocksOfDenseInverse(Information(1, {}, 4.0)); }

TEST(DiagonalBlocksOfInverse, ReadsTheLowerTriangleAlone) {
  const Eigen::SparseMatrix<double> information = Information(5, {{0, 1}, {1, 2}, {4, 0}, {3, 4}}, 0.5);
  const auto blocks = DiagonalBlocksOfInverse(information);
  const auto of_lower = DiagonalBlocksOfInverse(information.triangularView<Eigen::Lower>());
  ASSERT_THAT(blocks, IsOk());
  ASSERT_THAT(of_lower, IsOk());
  EXPECT_EQ(*blocks, *of_lower);
}

TEST(DiagonalBlocksOfInverse, OfNothingIsNothing) {
  const auto blocks = DiagonalBlocksOfInverse(Eigen::SparseMatrix<double>(0, 0));
  ASSERT_THAT(blocks, IsOk());
  EXPECT_TRUE(blocks->empty());
}

TEST(DiagonalBlocksOfInverse, RefusesWhatIsNotDetermined) {
  // Differences alone are known: the sum of both nodes is not.
  Eigen::MatrixXd dense(12, 12);
  dense << Matrix6d::Identity(), -Matrix6d::Identity(), -Matrix6d::Identity(), Matrix6d::Identity();
  EXPECT_THAT(DiagonalBlocksOfInverse(dense.sparseView()), HasCode(absl::StatusCode::kFailedPrecondition));
  dense.setIdentity();
  dense(3, 3) = -1.0;
  EXPECT_THAT(DiagonalBlocksOfInverse(dense.sparseView()), HasCode(absl::StatusCode::kFailedPrecondition));
}

TEST(DiagonalBlocksOfInverse, Stops) {
  std::stop_source source;
  source.request_stop();
  const Eigen::SparseMatrix<double> information = Information(2, {{0, 1}}, 1.0);
  EXPECT_THAT(DiagonalBlocksOfInverse(information, {.cancellation = source.get_token(), .deadline = {}}),
              HasCode(absl::StatusCode::kCancelled));
  const Stop late{.cancellation = {}, .deadline = std::chrono::steady_clock::now()};
  EXPECT_THAT(DiagonalBlocksOfInverse(information, late), HasCode(absl::StatusCode::kDeadlineExceeded));
}

}  // namespace
}  // namespace curvereg
