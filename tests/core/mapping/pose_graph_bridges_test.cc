// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/pose_graph_bridges.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/mapping/pose_graph_residual.h"
#include "tests/testing/matchers.h"
#include "tests/testing/pose_graphs.h"

namespace curvereg {
namespace {

using testing::IsNear;
using testing::KnownGraph;

constexpr double kSquaredScale = 25.0;
const Matrix6d kCovariance = testing::DiagonalCovariance(1e-3, 1e-2);
const Vector6d kWrong = (Vector6d() << 0.1, 0.2, 1.0, 4.0, -3.0, 0.5).finished();

// Two triangles, nodes 0 to 2 and 3 to 5. A wrong edge, number 6, joins them, and right ones besides.
KnownGraph TwoTriangles(int num_right_edges) {
  KnownGraph known;
  for (int i = 0; i < 6; ++i) {
    const double s = static_cast<double>(i);
    known.T_graph_node.push_back(
        TransformFromVector((Vector6d() << 0.1 * s, 0.0, 0.5 * s, 3.0 * s, std::sin(s), 0.0).finished()));
  }
  known.graph.T_graph_node = known.T_graph_node;
  for (const int first : {0, 3}) {
    known.AddEdge(first + 1, first, kCovariance);
    known.AddEdge(first + 2, first + 1, kCovariance);
    known.AddEdge(first + 2, first, kCovariance);
  }
  known.AddEdge(4, 1, kCovariance, kWrong);
  for (int i = 0; i < num_right_edges; ++i) known.AddEdge(i % 3, 3 + (i + 1) % 3, kCovariance);
  return known;
}

// Poses of the second triangle as the wrong edge has them.
std::vector<RigidTransform> Misled(const KnownGraph& known) {
  std::vector<RigidTransform> T_graph_node = known.T_graph_node;
  const RigidTransform T_wrong_right =
      T_graph_node[1] * known.graph.edges[6].T_target_source * T_graph_node[4].inverse();
  for (size_t i = 3; i < 6; ++i) T_graph_node[i] = T_wrong_right * T_graph_node[i];
  return T_graph_node;
}

bool Move(const KnownGraph& known, std::vector<RigidTransform>& T_graph_node) {
  const auto squared_error = [&](int edge, const RigidTransform& T_graph_source, const RigidTransform& T_graph_target) {
    const PoseGraphEdge& measured = known.graph.edges[static_cast<size_t>(edge)];
    return (Whitening(measured.covariance, {}) * EdgeError(measured.T_target_source, T_graph_source, T_graph_target))
        .squaredNorm();
  };
  std::vector<double> weights;
  for (size_t i = 0; i < known.graph.edges.size(); ++i) {
    const PoseGraphEdge& edge = known.graph.edges[i];
    const double square = squared_error(static_cast<int>(i), T_graph_node[static_cast<size_t>(edge.source)],
                                        T_graph_node[static_cast<size_t>(edge.target)]);
    weights.push_back(std::pow(kSquaredScale / (kSquaredScale + square), 2));
  }
  return MoveParts(known.graph, weights, kSquaredScale, squared_error, T_graph_node);
}

TEST(HeaviestForest, TakesTheHeaviestOfEachCycle) {
  const KnownGraph known = TwoTriangles(1);
  const std::vector<bool> expected = {false, true, true, true, true, false, true, false};
  EXPECT_EQ(HeaviestForest(known.graph, {0.5, 0.9, 0.7, 1.0, 1.0, 1.0, 1e-9, 1e-12}), expected);
  EXPECT_TRUE(HeaviestForest({}, {}).empty());
}

TEST(MoveParts, FollowsTheEdgesThatAgree) {
  const KnownGraph known = TwoTriangles(2);
  std::vector<RigidTransform> T_graph_node = Misled(known);
  EXPECT_TRUE(Move(known, T_graph_node));
  for (size_t i = 0; i < 6; ++i) EXPECT_THAT(T_graph_node[i], IsNear(known.T_graph_node[i], 1e-9, 1e-9)) << i;
  EXPECT_FALSE(Move(known, T_graph_node));
}

TEST(MoveParts, LeavesAloneWhatNoMajorityWantsElsewhere) {
  for (const int num_right_edges : {0, 1}) {
    const KnownGraph known = TwoTriangles(num_right_edges);
    std::vector<RigidTransform> T_graph_node = Misled(known);
    EXPECT_FALSE(Move(known, T_graph_node));
    EXPECT_THAT(T_graph_node[5], IsNear(Misled(known)[5], 0.0, 1e-12));
  }
}

TEST(MoveParts, FindsPartsThatNoBelievedEdgeHolds) {
  const KnownGraph known = TwoTriangles(2);
  std::vector<RigidTransform> T_graph_node = known.T_graph_node;
  for (size_t i = 3; i < 6; ++i) T_graph_node[i].translation().z() += 50.0;
  EXPECT_TRUE(Move(known, T_graph_node));
  EXPECT_THAT(T_graph_node[4], IsNear(known.T_graph_node[4], 1e-9, 1e-9));
}

TEST(MoveParts, OfNothingMovesNothing) {
  std::vector<RigidTransform> T_graph_node;
  EXPECT_FALSE(Move({}, T_graph_node));
}

}  // namespace
}  // namespace curvereg
