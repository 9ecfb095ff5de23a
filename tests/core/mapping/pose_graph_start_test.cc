// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/pose_graph_start.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "core/base/parallel.h"
#include "tests/testing/matchers.h"
#include "tests/testing/pose_graphs.h"

namespace curvereg {
namespace {

using testing::DiagonalCovariance;
using testing::Drive;
using ::testing::ElementsAre;
using testing::IsNear;
using testing::KnownGraph;

const Matrix6d kCovariance = DiagonalCovariance(1e-3, 1e-2);

KnownGraph Places(int num_nodes) {
  KnownGraph known;
  for (int i = 0; i < num_nodes; ++i)
    known.T_graph_node.push_back(
        TransformFromVector((Vector6d() << 0.1 * i, 0.0, 0.3 * i, 2.0 * i, i % 2, 0.0).finished()));
  known.graph.T_graph_node.assign(known.T_graph_node.size(), known.T_graph_node[0]);
  return known;
}

Vector6d Along(double x) { return x * Vector6d::Unit(3); }

TEST(ConnectedNodes, JoinsToTheLowestIndex) {
  ConnectedNodes connected(5);
  EXPECT_TRUE(connected.Join(4, 3));
  EXPECT_TRUE(connected.Join(3, 1));
  EXPECT_FALSE(connected.Join(1, 4));
  EXPECT_EQ(connected.First(4), 1);
  EXPECT_EQ(connected.First(0), 0);
}

TEST(FirstNodes, AreThoseOfTheComponents) {
  KnownGraph known = Places(6);
  known.AddEdge(5, 1, kCovariance);
  known.AddEdge(4, 5, kCovariance);
  known.AddEdge(3, 2, kCovariance);
  EXPECT_THAT(FirstNodes(known.graph), ElementsAre(0, 1, 2, 2, 1, 1));
  EXPECT_TRUE(FirstNodes({}).empty());
}

TEST(FindEdgeSupport, CountsTrianglesAndParallels) {
  KnownGraph known = Places(4);
  known.AddEdge(1, 0, kCovariance);
  known.AddEdge(1, 2, kCovariance);
  known.AddEdge(0, 2, kCovariance);
  known.AddEdge(0, 1, kCovariance, Along(1.0));  // beside the first one, and wrong
  known.AddEdge(3, 2, kCovariance);              // closes nothing
  const std::vector<EdgeSupport> support = FindEdgeSupport(known.graph, {});
  ASSERT_EQ(support.size(), 5U);
  const auto counts = [&](size_t i) { return std::pair(support[i].num_cycles, support[i].num_consistent); };
  EXPECT_EQ(counts(0), std::pair(2, 1));
  EXPECT_EQ(counts(1), std::pair(2, 1));
  EXPECT_EQ(counts(2), std::pair(2, 1));
  EXPECT_EQ(counts(3), std::pair(2, 0));
  EXPECT_EQ(counts(4), std::pair(0, 0));
}

TEST(FindEdgeSupport, ForgivesWhatTheCovariancesExplain) {
  for (const double sigmas : {4.0, 6.0}) {
    KnownGraph known = Places(3);
    known.AddEdge(1, 0, DiagonalCovariance(1e-6, 1e-2));
    known.AddEdge(2, 1, DiagonalCovariance(1e-6, 1e-2));
    known.AddEdge(2, 0, DiagonalCovariance(1e-6, 1e-2), Along(sigmas * std::sqrt(3.0) * 1e-2));
    const PoseGraphOptions options{.kernel_sigmas = 5.0, .least_sigma_rad = 1e-6};
    EXPECT_EQ(FindEdgeSupport(known.graph, options)[2].num_consistent, sigmas < 5.0 ? 1 : 0) << sigmas;
  }
}

TEST(FindEdgeSupport, IsTheSameAtAnyThreadCount) {
  const KnownGraph drive = Drive(100, 1);
  std::vector<EdgeSupport> one, four;
  WithThreadLimit(1, [&] { one = FindEdgeSupport(drive.graph, {}); });
  WithThreadLimit(4, [&] { four = FindEdgeSupport(drive.graph, {}); });
  ASSERT_EQ(one.size(), four.size());
  for (size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].num_cycles, four[i].num_cycles);
    EXPECT_EQ(one[i].num_consistent, four[i].num_consistent);
  }
}

TEST(PosesThroughSupportedEdges, GoAroundWrongEdges) {
  KnownGraph drive = Drive(40, 2);
  for (const size_t i : {6U, 20U, 57U, 58U}) {
    PoseGraphEdge& edge = drive.graph.edges[i];
    edge.T_target_source =
        TransformFromVector((Vector6d() << 0.0, 1.0, 0.0, 3.0, 0.0, 0.0).finished()) * edge.T_target_source;
  }
  const std::vector<RigidTransform> T_graph_node = PosesThroughSupportedEdges(drive.graph, {});
  EXPECT_THAT(T_graph_node[0], IsNear(drive.graph.T_graph_node[0], 0.0, 1e-12));
  for (size_t i = 0; i < T_graph_node.size(); ++i)
    EXPECT_THAT(T_graph_node[i], IsNear(drive.T_graph_node[i], 0.3, 0.02));
}

TEST(PosesThroughSupportedEdges, UseAnEdgeBothWaysAndLeaveOthersAlone) {
  KnownGraph known = Places(4);
  known.AddEdge(0, 1, kCovariance);
  known.AddEdge(2, 1, kCovariance);
  const std::vector<RigidTransform> T_graph_node = PosesThroughSupportedEdges(known.graph, {});
  for (const size_t i : {0U, 1U, 2U}) EXPECT_THAT(T_graph_node[i], IsNear(known.T_graph_node[i], 1e-9, 1e-9));
  EXPECT_THAT(T_graph_node[3], IsNear(known.graph.T_graph_node[3], 0.0, 1e-12));
}

}  // namespace
}  // namespace curvereg
