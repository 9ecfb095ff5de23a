// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Pose graphs of which a tenth of the edges is wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "core/mapping/pose_graph.h"
#include "tests/testing/matchers.h"
#include "tests/testing/pose_graphs.h"

namespace curvereg {
namespace {

using testing::Drive;
using testing::IsOk;
using testing::KnownGraph;
using testing::NormalVector;

double LargestDistance(const std::vector<RigidTransform>& some, const std::vector<RigidTransform>& others) {
  double largest = 0.0;
  for (size_t i = 0; i < some.size(); ++i) largest = std::max(largest, Difference(some[i], others[i]).translation_m);
  return largest;
}

struct WrongEdges {
  const char* name;
  double turn_rad;    // at most
  double distance_m;  // exactly
};

class WrongEdgesTest : public ::testing::TestWithParam<WrongEdges> {};

// Wrong edges are drawn at random, but each node keeps a majority of right ones: without it no method could tell.
std::set<size_t> SpoilEdges(PoseGraph& graph, const WrongEdges& wrong, uint64_t seed) {
  sim::RandomStream random(seed);
  std::vector<int> right(graph.T_graph_node.size(), 0), spoilt(graph.T_graph_node.size(), 0);
  for (const PoseGraphEdge& edge : graph.edges)
    for (const int node : {edge.source, edge.target}) ++right[static_cast<size_t>(node)];
  std::set<size_t> indices;
  while (10 * indices.size() < graph.edges.size()) {
    const size_t index = random.Bits() % graph.edges.size();
    PoseGraphEdge& edge = graph.edges[index];
    const auto bears = [&](int node) {
      return 3 * (spoilt[static_cast<size_t>(node)] + 1) <= right[static_cast<size_t>(node)];
    };
    if (indices.contains(index) || !bears(edge.source) || !bears(edge.target)) continue;
    Vector6d error = NormalVector(random);
    error.head<3>() *= wrong.turn_rad * random.Uniform(0.3, 1.0) / error.head<3>().norm();
    error.tail<3>() *= wrong.distance_m / error.tail<3>().norm();
    edge.T_target_source = TransformFromVector(error) * edge.T_target_source;
    for (const int node : {edge.source, edge.target}) ++spoilt[static_cast<size_t>(node)];
    indices.insert(index);
  }
  return indices;
}

TEST_P(WrongEdgesTest, MoveNoPose) {
  for (uint64_t seed = 1; seed <= 15; ++seed) {
    KnownGraph drive = Drive(40, seed);
    const std::set<size_t> wrong = SpoilEdges(drive.graph, GetParam(), seed);
    PoseGraph without = drive.graph;
    without.T_graph_node = drive.T_graph_node;
    without.edges.clear();
    for (size_t i = 0; i < drive.graph.edges.size(); ++i)
      if (!wrong.contains(i)) without.edges.push_back(drive.graph.edges[i]);
    // The first guess is chained through wrong edges, too.
    for (const PoseGraphEdge& edge : drive.graph.edges)
      if (edge.target == edge.source - 1)
        drive.graph.T_graph_node[static_cast<size_t>(edge.source)] =
            drive.graph.T_graph_node[static_cast<size_t>(edge.target)] * edge.T_target_source;
    const auto with = OptimizePoseGraph(drive.graph);
    const auto expected = OptimizePoseGraph(without);
    ASSERT_THAT(with, IsOk());
    ASSERT_THAT(expected, IsOk());
    EXPECT_TRUE(with->converged);
    EXPECT_LT(LargestDistance(with->T_graph_node, expected->T_graph_node), 0.005) << "seed " << seed;
    for (size_t i = 0; i < drive.graph.edges.size(); ++i) {
      if (wrong.contains(i)) {
        EXPECT_LT(with->edge_weights[i], 0.01) << "seed " << seed << ", edge " << i;
      } else {
        EXPECT_GT(with->edge_weights[i], 0.05) << "seed " << seed << ", edge " << i;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(OptimizePoseGraph, WrongEdgesTest,
                         ::testing::Values(WrongEdges{"AnyTurnAnd20m", 3.1, 20.0}, WrongEdges{"Only30cm", 0.0, 0.3},
                                           WrongEdges{"OnlyTurned", 0.3, 0.0}),
                         [](const auto& wrong) { return wrong.param.name; });

}  // namespace
}  // namespace curvereg
