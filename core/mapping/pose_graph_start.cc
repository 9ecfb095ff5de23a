// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/pose_graph_start.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

#include "core/base/parallel.h"
#include "core/base/small_matrices.h"
#include "core/mapping/pose_graph_residual.h"

namespace curvereg {
namespace {

constexpr int kMaxCycles = 32;  // asked of one edge

// An edge as seen from one of its nodes.
struct Neighbour {
  int node = 0;
  int edge = 0;
  bool operator<(const Neighbour& other) const { return std::pair(node, edge) < std::pair(other.node, other.edge); }
};
using Neighbours = std::vector<std::vector<Neighbour>>;

Neighbours NeighboursOfNodes(const PoseGraph& graph) {
  Neighbours neighbours(graph.T_graph_node.size());
  for (size_t i = 0; i < graph.edges.size(); ++i) {
    const PoseGraphEdge& edge = graph.edges[i];
    neighbours[static_cast<size_t>(edge.source)].push_back({edge.target, static_cast<int>(i)});
    neighbours[static_cast<size_t>(edge.target)].push_back({edge.source, static_cast<int>(i)});
  }
  for (std::vector<Neighbour>& of_node : neighbours) std::sort(of_node.begin(), of_node.end());
  return neighbours;
}

// An edge turned so that it leads to `target`.
struct Step {
  RigidTransform T_target_source;
  Matrix6d covariance;
};

Step StepTo(int target, const PoseGraphEdge& edge) {
  if (edge.target == target) return {edge.T_target_source, edge.covariance};
  return {edge.T_target_source.inverse(), InverseCovariance(edge.T_target_source, edge.covariance)};
}

// T_a_c of T_a_b and T_b_c.
Step Chained(const Step& a_b, const Step& b_c) {
  return {a_b.T_target_source * b_c.T_target_source,
          a_b.covariance + TransportedCovariance(b_c.covariance, a_b.T_target_source)};
}

// Whether two ways from one node to another lead to the same place.
bool Agree(const Step& one, const Step& other, const PoseGraphOptions& options) {
  const Vector6d e = EdgeError(one.T_target_source, other.T_target_source, RigidTransform::Identity());
  Matrix6d covariance = one.covariance + other.covariance;
  covariance.diagonal().head<3>().array() += options.least_sigma_rad * options.least_sigma_rad;
  covariance.diagonal().tail<3>().array() += options.least_sigma_m * options.least_sigma_m;
  return SquaredMahalanobisDistance(e, covariance) <= options.kernel_sigmas * options.kernel_sigmas;
}

EdgeSupport SupportOf(int index, const PoseGraph& graph, const Neighbours& neighbours,
                      const PoseGraphOptions& options) {
  const PoseGraphEdge& edge = graph.edges[static_cast<size_t>(index)];
  const Step direct{edge.T_target_source, edge.covariance};
  EdgeSupport support;
  const auto count = [&](const Step& other) {
    ++support.num_cycles;
    support.num_consistent += Agree(direct, other, options) ? 1 : 0;
  };
  for (const Neighbour& to : neighbours[static_cast<size_t>(edge.target)]) {
    if (to.edge == index) continue;
    const Step last = StepTo(edge.target, graph.edges[static_cast<size_t>(to.edge)]);
    if (to.node == edge.source) {
      count(last);
      continue;
    }
    const std::vector<Neighbour>& of_source = neighbours[static_cast<size_t>(edge.source)];
    auto from = std::lower_bound(of_source.begin(), of_source.end(), Neighbour{to.node, 0});
    for (; from != of_source.end() && from->node == to.node && support.num_cycles < kMaxCycles; ++from)
      count(Chained(last, StepTo(to.node, graph.edges[static_cast<size_t>(from->edge)])));
    if (support.num_cycles >= kMaxCycles) break;
  }
  return support;
}

// Mean variance in squares of the least deviations, times a penalty for what nothing confirms.
double Length(const PoseGraphEdge& edge, const EdgeSupport& support, const PoseGraphOptions& options) {
  const Vector6d variance = edge.covariance.diagonal();
  const double rotation = variance.head<3>().sum() / (options.least_sigma_rad * options.least_sigma_rad);
  const double translation = variance.tail<3>().sum() / (options.least_sigma_m * options.least_sigma_m);
  const double length = std::max(1.0, (rotation + translation) / 6.0);
  if (2 * support.num_consistent > support.num_cycles) return length;
  if (support.num_consistent > 0) return 1e3 * length;
  return (support.num_cycles == 0 ? 1e6 : 1e9) * length;
}

}  // namespace

ConnectedNodes::ConnectedNodes(std::size_t num_nodes) : towards_first_(num_nodes) {
  std::iota(towards_first_.begin(), towards_first_.end(), 0);
}

int ConnectedNodes::First(int node) {
  for (;;) {
    int& next = towards_first_[static_cast<size_t>(node)];
    if (next == node) return node;
    next = towards_first_[static_cast<size_t>(next)];
    node = next;
  }
}

bool ConnectedNodes::Join(int one, int other) {
  const int first = First(one), second = First(other);
  towards_first_[static_cast<size_t>(std::max(first, second))] = std::min(first, second);
  return first != second;
}

std::vector<int> FirstNodes(const PoseGraph& graph) {
  ConnectedNodes connected(graph.T_graph_node.size());
  for (const PoseGraphEdge& edge : graph.edges) connected.Join(edge.source, edge.target);
  std::vector<int> first(graph.T_graph_node.size());
  for (size_t i = 0; i < first.size(); ++i) first[i] = connected.First(static_cast<int>(i));
  return first;
}

std::vector<EdgeSupport> FindEdgeSupport(const PoseGraph& graph, const PoseGraphOptions& options) {
  constexpr int kEdgesPerTask = 64;
  const Neighbours neighbours = NeighboursOfNodes(graph);
  std::vector<EdgeSupport> support(graph.edges.size());
  const auto num_edges = static_cast<int>(support.size());
  ParallelFor((num_edges + kEdgesPerTask - 1) / kEdgesPerTask, [&](int task) {
    const int end = std::min(num_edges, (task + 1) * kEdgesPerTask);
    for (int i = task * kEdgesPerTask; i < end; ++i)
      support[static_cast<size_t>(i)] = SupportOf(i, graph, neighbours, options);
  });
  return support;
}

std::vector<RigidTransform> PosesThroughSupportedEdges(const PoseGraph& graph, const PoseGraphOptions& options) {
  const std::vector<EdgeSupport> support = FindEdgeSupport(graph, options);
  const Neighbours neighbours = NeighboursOfNodes(graph);
  const std::vector<int> first = FirstNodes(graph);
  std::vector<RigidTransform> T_graph_node = graph.T_graph_node;
  std::vector<double> distances(first.size(), std::numeric_limits<double>::infinity());
  // Dijkstra's; equal distances by node, so that the order is always the same.
  std::set<std::pair<double, int>> open;
  const auto reach = [&](int node, double distance) {
    open.emplace(distance, node);
    distances[static_cast<size_t>(node)] = distance;
  };
  for (size_t i = 0; i < first.size(); ++i)
    if (first[i] == static_cast<int>(i)) reach(first[i], 0.0);
  while (!open.empty()) {
    const auto [distance, node] = *open.begin();
    open.erase(open.begin());
    if (distance > distances[static_cast<size_t>(node)]) continue;
    for (const Neighbour& next : neighbours[static_cast<size_t>(node)]) {
      const PoseGraphEdge& edge = graph.edges[static_cast<size_t>(next.edge)];
      const double longer = distance + Length(edge, support[static_cast<size_t>(next.edge)], options);
      if (longer >= distances[static_cast<size_t>(next.node)]) continue;
      reach(next.node, longer);
      T_graph_node[static_cast<size_t>(next.node)] =
          T_graph_node[static_cast<size_t>(node)] *
          (edge.target == node ? edge.T_target_source : edge.T_target_source.inverse());
    }
  }
  return T_graph_node;
}

}  // namespace curvereg
