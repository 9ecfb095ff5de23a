// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/pose_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <chrono>
#include <functional>
#include <limits>
#include <numeric>
#include <stop_token>
#include <string>
#include <vector>

#include "core/mapping/pose_graph_residual.h"
#include "tests/testing/matchers.h"
#include "tests/testing/pose_graphs.h"

namespace curvereg {
namespace {

using testing::DiagonalCovariance;
using testing::Drive;
using ::testing::Each;
using testing::HasCode;
using ::testing::HasSubstr;
using testing::IsNear;
using testing::IsOk;
using testing::KnownGraph;

// Four corners of a square of 10 m, edges around it and from each corner to the next but one.
KnownGraph Square() {
  KnownGraph square;
  for (int i = 0; i < 4; ++i) {
    Vector6d pose = Vector6d::Zero();
    pose[2] = 0.5 * std::numbers::pi * i;
    pose[3] = i == 1 || i == 2 ? 10.0 : 0.0;
    pose[4] = i >= 2 ? 10.0 : 0.0;
    square.T_graph_node.push_back(TransformFromVector(pose));
  }
  for (int i = 0; i < 4; ++i) square.AddEdge((i + 1) % 4, i, DiagonalCovariance(0.01, 0.1));
  square.graph.T_graph_node = square.T_graph_node;
  return square;
}

// Nodes 0, 1 and 2 on a line at 0, 1 and 2 m; the edges between neighbours are too long by 2 and 4 cm, the direct one
// is too short by 6 cm; their deviations are 1, 2 and 3 cm.
KnownGraph Triangle() {
  KnownGraph triangle;
  for (int i = 0; i < 3; ++i)
    triangle.T_graph_node.push_back(TransformFromVector(static_cast<double>(i) * Vector6d::Unit(3)));
  triangle.AddEdge(1, 0, DiagonalCovariance(1e-3, 0.01), 0.02 * Vector6d::Unit(3));
  triangle.AddEdge(2, 1, DiagonalCovariance(1e-3, 0.02), 0.04 * Vector6d::Unit(3));
  triangle.AddEdge(2, 0, DiagonalCovariance(1e-3, 0.03), -0.06 * Vector6d::Unit(3));
  triangle.graph.T_graph_node = triangle.T_graph_node;
  return triangle;
}

double LargestDistance(const std::vector<RigidTransform>& some, const std::vector<RigidTransform>& others) {
  double largest = 0.0;
  for (size_t i = 0; i < some.size(); ++i) largest = std::max(largest, Difference(some[i], others[i]).translation_m);
  return largest;
}

TEST(OptimizePoseGraph, ExactLoopIsExact) {
  KnownGraph square = Square();
  for (size_t i = 1; i < 4; ++i)
    square.graph.T_graph_node[i] = square.graph.T_graph_node[i] * TransformFromVector(0.3 * Vector6d::Ones());
  const auto result = OptimizePoseGraph(square.graph);
  ASSERT_THAT(result, IsOk());
  EXPECT_TRUE(result->converged);
  for (size_t i = 0; i < 4; ++i) EXPECT_THAT(result->T_graph_node[i], IsNear(square.T_graph_node[i], 1e-6, 1e-7));
  EXPECT_THAT(result->edge_weights, Each(::testing::DoubleNear(1.0, 1e-6)));
}

// The misclosure of 12 cm is shared out by variance, 1 : 4 : 9, under a kernel so wide that it is the square.
TEST(OptimizePoseGraph, SpreadsErrorsAsCovariancesSay) {
  const auto result = OptimizePoseGraph(Triangle().graph, {.kernel_sigmas = 1e4});
  ASSERT_THAT(result, IsOk());
  const double x_1 = 1.02 - 0.12 / 14.0, x_2 = 2.06 - 0.12 * 5.0 / 14.0;
  EXPECT_THAT(result->T_graph_node[1], IsNear(TransformFromVector(x_1 * Vector6d::Unit(3)), 1e-6, 1e-6));
  EXPECT_THAT(result->T_graph_node[2], IsNear(TransformFromVector(x_2 * Vector6d::Unit(3)), 1e-6, 1e-6));
  // Two ways lead to each node: 1 against 4 + 9, 1 + 4 against 9 cm^2.
  EXPECT_NEAR(result->covariances[1](3, 3), 1e-4 * 13.0 / 14.0, 1e-8);
  EXPECT_NEAR(result->covariances[2](3, 3), 1e-4 * 45.0 / 14.0, 1e-8);
  EXPECT_THAT(result->edge_weights, Each(::testing::DoubleNear(1.0, 1e-6)));
}

// Wherever the first node is: all turns with it.
TEST(OptimizePoseGraph, MovesWithTheFirstNode) {
  KnownGraph drive = Drive(20, 4);
  const auto here = OptimizePoseGraph(drive.graph);
  const RigidTransform T_there_here =
      TransformFromVector((Vector6d() << 0.5, -1.0, 2.0, 300.0, -200.0, 10.0).finished());
  for (RigidTransform& T : drive.graph.T_graph_node) T = T_there_here * T;
  const auto there = OptimizePoseGraph(drive.graph);
  ASSERT_THAT(here, IsOk());
  ASSERT_THAT(there, IsOk());
  EXPECT_EQ(there->T_graph_node[0].matrix(), drive.graph.T_graph_node[0].matrix());
  const Matrix6d adjoint = Adjoint(T_there_here);
  for (size_t i = 0; i < here->T_graph_node.size(); ++i) {
    EXPECT_THAT(there->T_graph_node[i], IsNear(T_there_here * here->T_graph_node[i], 1e-4, 1e-5));
    const Matrix6d expected = adjoint * here->covariances[i] * adjoint.transpose();
    EXPECT_LE((there->covariances[i] - expected).norm(), 1e-3 * expected.norm());
  }
}

TEST(OptimizePoseGraph, HoldsTheFirstNodeOfEachComponent) {
  KnownGraph known = Square();
  const std::vector<RigidTransform> square = known.T_graph_node;
  known.T_graph_node.insert(known.T_graph_node.end(), square.begin(), square.end());
  known.T_graph_node.push_back(square[2]);
  known.AddEdge(7, 5, DiagonalCovariance(0.01, 0.1));
  known.AddEdge(6, 7, DiagonalCovariance(0.01, 0.1));
  known.graph.T_graph_node = known.T_graph_node;
  for (const size_t i : {1U, 2U, 3U, 6U, 7U}) known.graph.T_graph_node[i] = RigidTransform::Identity();
  const auto result = OptimizePoseGraph(known.graph);
  ASSERT_THAT(result, IsOk());
  for (size_t i = 0; i < 9; ++i) EXPECT_THAT(result->T_graph_node[i], IsNear(known.T_graph_node[i], 1e-6, 1e-7)) << i;
  for (const size_t held : {0U, 4U, 5U, 8U}) EXPECT_EQ(result->covariances[held], Matrix6d::Zero());
  EXPECT_GT(result->covariances[6].trace(), result->covariances[7].trace());
}

TEST(OptimizePoseGraph, OfNothingIsNothingAndOfOneNodeTheNode) {
  const auto nothing = OptimizePoseGraph({});
  ASSERT_THAT(nothing, IsOk());
  EXPECT_TRUE(nothing->converged && nothing->T_graph_node.empty() && nothing->covariances.empty());
  const RigidTransform T = TransformFromVector(Vector6d::Ones());
  const auto one = OptimizePoseGraph({{T}, {}});
  ASSERT_THAT(one, IsOk());
  EXPECT_TRUE(one->converged);
  EXPECT_EQ(one->T_graph_node[0].matrix(), T.matrix());
  EXPECT_EQ(one->covariances[0], Matrix6d::Zero());
}

TEST(OptimizePoseGraph, RefusesBadInput) {
  const auto message_after = [](const std::function<void(PoseGraph&, PoseGraphOptions&)>& change) {
    PoseGraph graph = Square().graph;
    PoseGraphOptions options;
    change(graph, options);
    const auto result = OptimizePoseGraph(graph, options);
    EXPECT_THAT(result, HasCode(absl::StatusCode::kInvalidArgument));
    return std::string(result.status().message());
  };
  EXPECT_THAT(message_after([](auto& graph, auto&) { graph.edges[2].source = 4; }), HasSubstr("edge 2 names no node"));
  EXPECT_THAT(message_after([](auto& graph, auto&) { graph.edges[1].target = -1; }), HasSubstr("edge 1 names no node"));
  EXPECT_THAT(message_after([](auto& graph, auto&) { graph.edges[0].source = graph.edges[0].target; }),
              HasSubstr("twice"));
  EXPECT_THAT(message_after([](auto& graph, auto&) { graph.edges[3].T_target_source.linear() *= 1.1; }),
              HasSubstr("rigid"));
  EXPECT_THAT(message_after([](auto& graph, auto&) { graph.T_graph_node[2].linear() *= 1.1; }), HasSubstr("node 2"));
  EXPECT_THAT(message_after([](auto& graph, auto&) { graph.edges[0].covariance(3, 3) = 0.0; }), HasSubstr("definite"));
  EXPECT_THAT(message_after([](auto& graph, auto&) { graph.edges[0].covariance(0, 1) = 1e-5; }), HasSubstr("definite"));
  EXPECT_THAT(message_after([](auto& graph, auto&) {
                graph.edges[0].covariance(4, 4) = std::numeric_limits<double>::quiet_NaN();
              }),
              HasSubstr("definite"));
  EXPECT_THAT(message_after([](auto&, auto& options) { options.kernel_sigmas = 0.0; }), HasSubstr("options"));
  EXPECT_THAT(message_after([](auto& graph, auto&) { graph.edges[0].T_target_source.translation().x() = 1e300; }),
              HasSubstr("numbers"));
}

// Whether either or neither of two contradicting edges is believed: the node stays where one of them or their middle
// puts it, and a covariance is told.
TEST(OptimizePoseGraph, KeepsAPartThatOnlyDoubtfulEdgesHold) {
  KnownGraph drive = Drive(10, 5);
  drive.T_graph_node.push_back(drive.T_graph_node.back());
  drive.graph.T_graph_node.push_back(drive.graph.T_graph_node.back());
  drive.AddEdge(10, 9, DiagonalCovariance(1e-3, 1e-2), 50.0 * Vector6d::Unit(3));
  drive.AddEdge(10, 8, DiagonalCovariance(1e-3, 1e-2), -50.0 * Vector6d::Unit(4));
  const auto result = OptimizePoseGraph(drive.graph);
  ASSERT_THAT(result, IsOk());
  EXPECT_LT(LargestDistance(result->T_graph_node, drive.T_graph_node), 60.0);
  EXPECT_TRUE(result->covariances[10].allFinite());
  EXPECT_GT(result->covariances[10](3, 3), result->covariances[9](3, 3));
  for (size_t i = 0; i < 10; ++i) EXPECT_THAT(result->T_graph_node[i], IsNear(drive.T_graph_node[i], 0.1, 0.01));
}

// The inverse of J^T W J with J from differences by left perturbations of the poses.
TEST(OptimizePoseGraph, CovariancesAreThoseOfTheDenseSystem) {
  KnownGraph drive = Drive(8, 6);
  sim::RandomStream random(6);
  for (PoseGraphEdge& edge : drive.graph.edges) edge.covariance = testing::RandomCovariance(random, 1e-3, 1e-2);
  const auto result = OptimizePoseGraph(drive.graph);
  ASSERT_THAT(result, IsOk());
  constexpr double kStep = 1e-6;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(42, 42);
  for (size_t k = 0; k < drive.graph.edges.size(); ++k) {
    const PoseGraphEdge& edge = drive.graph.edges[k];
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6, 42);
    for (int column = 0; column < 42; ++column) {
      std::vector<RigidTransform> plus = result->T_graph_node, minus = plus;
      const auto node = static_cast<size_t>(column / 6 + 1);
      plus[node] = TransformFromVector(kStep * Vector6d::Unit(column % 6)) * plus[node];
      minus[node] = TransformFromVector(-kStep * Vector6d::Unit(column % 6)) * minus[node];
      const auto error = [&](const std::vector<RigidTransform>& T) {
        return EdgeError(edge.T_target_source, T[static_cast<size_t>(edge.source)],
                         T[static_cast<size_t>(edge.target)]);
      };
      J.col(column) = Whitening(edge.covariance, {}) * (error(plus) - error(minus)) / (2.0 * kStep);
    }
    information += result->edge_weights[k] * J.transpose() * J;
  }
  const Eigen::MatrixXd expected = information.inverse();
  for (int i = 1; i < 8; ++i) {
    const Matrix6d block = expected.block<6, 6>(6 * i - 6, 6 * i - 6);
    EXPECT_LT((result->covariances[static_cast<size_t>(i)] - block).norm(), 1e-5 * block.norm()) << "node " << i;
  }
}

TEST(OptimizePoseGraph, LeavesCovariancesOutUnlessAsked) {
  const auto result = OptimizePoseGraph(Square().graph, {.with_covariances = false});
  ASSERT_THAT(result, IsOk());
  EXPECT_TRUE(result->covariances.empty());
}

TEST(OptimizePoseGraph, TellsWhenItDidNotConverge) {
  const auto result = OptimizePoseGraph(Drive(20, 7).graph, {.max_iterations = 1});
  ASSERT_THAT(result, IsOk());
  EXPECT_FALSE(result->converged);
  EXPECT_EQ(result->iterations, 1);
}

TEST(OptimizePoseGraph, Stops) {
  const PoseGraph graph = Drive(20, 8).graph;
  std::stop_source source;
  source.request_stop();
  EXPECT_THAT(OptimizePoseGraph(graph, {}, {.cancellation = source.get_token(), .deadline = {}}),
              HasCode(absl::StatusCode::kCancelled));
  EXPECT_THAT(OptimizePoseGraph(graph, {}, {.cancellation = {}, .deadline = std::chrono::steady_clock::now()}),
              HasCode(absl::StatusCode::kDeadlineExceeded));
}

TEST(PoseGraphCovariances, AreThoseThatTheOptimisationGives) {
  KnownGraph drive = Drive(30, 4);
  drive.graph.edges[11].T_target_source.translation().x() += 10.0;
  const auto whole = OptimizePoseGraph(drive.graph);
  const auto without = OptimizePoseGraph(drive.graph, {.with_covariances = false});
  ASSERT_THAT(whole, IsOk());
  ASSERT_THAT(without, IsOk());
  const auto covariances = PoseGraphCovariances(drive.graph, *without, {});
  ASSERT_THAT(covariances, IsOk());
  ASSERT_EQ(covariances->size(), whole->covariances.size());
  for (size_t i = 0; i < covariances->size(); ++i) EXPECT_EQ((*covariances)[i], whole->covariances[i]) << i;
  EXPECT_THAT(PoseGraphCovariances(drive.graph, {}, {}), HasCode(absl::StatusCode::kInvalidArgument));
  std::stop_source source;
  source.request_stop();
  EXPECT_THAT(PoseGraphCovariances(drive.graph, *without, {}, {source.get_token(), std::nullopt}),
              HasCode(absl::StatusCode::kCancelled));
}

TEST(OptimizePoseGraph, StopsLongBeforeItsEnd) {
  const PoseGraph graph = Drive(1000, 8).graph;
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  ASSERT_THAT(OptimizePoseGraph(graph, {}), IsOk());
  const auto whole = Clock::now() - start;
  const auto deadline = Clock::now() + whole / 4;
  EXPECT_THAT(OptimizePoseGraph(graph, {}, {.cancellation = {}, .deadline = deadline}),
              HasCode(absl::StatusCode::kDeadlineExceeded));
  EXPECT_LE(Clock::now() - deadline, whole / 4);
}

TEST(OptimizePoseGraph, GivesTheSameBytesAtAnyThreadCount) {
  KnownGraph drive = Drive(150, 9);
  for (size_t i = 0; i < drive.graph.edges.size(); i += 12)
    drive.graph.edges[i].T_target_source.translation().x() += 2.0;
  const auto one = OptimizePoseGraph(drive.graph, {.num_threads = 1});
  ASSERT_THAT(one, IsOk());
  for (const int num_threads : {0, 2, 5}) {
    const auto other = OptimizePoseGraph(drive.graph, {.num_threads = num_threads});
    ASSERT_THAT(other, IsOk());
    for (size_t i = 0; i < one->T_graph_node.size(); ++i) {
      EXPECT_EQ(one->T_graph_node[i].matrix(), other->T_graph_node[i].matrix());
      EXPECT_EQ(one->covariances[i], other->covariances[i]);
    }
    EXPECT_EQ(one->edge_weights, other->edge_weights);
  }
}

}  // namespace
}  // namespace curvereg
