// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/pose_graph_bridges.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

#include "core/mapping/pose_graph_kernel.h"
#include "core/mapping/pose_graph_start.h"

namespace curvereg {
namespace {

std::vector<bool> HoldingEdges(const PoseGraph& graph, const std::vector<double>& weights) {
  std::vector<bool> holds = HeaviestForest(graph, weights);
  for (size_t i = 0; i < weights.size(); ++i) holds[i] = holds[i] || weights[i] >= kGivenUpWeight;
  return holds;
}

// Depth-first search: a node's part, what hangs on it, is a range of `order`.
struct Search {
  std::vector<int> order;        // nodes as they are come to
  std::vector<int> place;        // of a node in `order`; -1: not come to yet
  std::vector<int> end;          // of a node's part in `order`
  std::vector<int> highest;      // least place that an edge of the part leads to, besides the one it hangs on
  std::vector<int> parent_edge;  // -1: none
};

// `edges_of_node`: of the edges to go along.
void SearchFrom(int root, const PoseGraph& graph, const std::vector<std::vector<int>>& edges_of_node, Search& search) {
  struct Level {
    int node;
    size_t next = 0;  // edge
  };
  std::vector<Level> path;
  const auto enter = [&](int node, int edge) {
    search.place[static_cast<size_t>(node)] = search.highest[static_cast<size_t>(node)] =
        static_cast<int>(search.order.size());
    search.parent_edge[static_cast<size_t>(node)] = edge;
    search.order.push_back(node);
    path.push_back({node});
  };
  enter(root, -1);
  while (!path.empty()) {
    const int node = path.back().node;
    int& highest = search.highest[static_cast<size_t>(node)];
    if (path.back().next < edges_of_node[static_cast<size_t>(node)].size()) {
      const int index = edges_of_node[static_cast<size_t>(node)][path.back().next++];
      const PoseGraphEdge& edge = graph.edges[static_cast<size_t>(index)];
      const int other = edge.source == node ? edge.target : edge.source;
      if (index == search.parent_edge[static_cast<size_t>(node)]) continue;
      if (search.place[static_cast<size_t>(other)] < 0) {
        enter(other, index);
      } else {
        highest = std::min(highest, search.place[static_cast<size_t>(other)]);
      }
      continue;
    }
    search.end[static_cast<size_t>(node)] = static_cast<int>(search.order.size());
    path.pop_back();
    if (path.empty()) continue;
    int& above = search.highest[static_cast<size_t>(path.back().node)];
    above = std::min(above, highest);
  }
}

Search SearchAlong(const PoseGraph& graph, const std::vector<bool>& is_used) {
  const size_t num_nodes = graph.T_graph_node.size();
  std::vector<std::vector<int>> edges_of_node(num_nodes);
  for (size_t i = 0; i < is_used.size(); ++i) {
    if (!is_used[i]) continue;
    edges_of_node[static_cast<size_t>(graph.edges[i].source)].push_back(static_cast<int>(i));
    edges_of_node[static_cast<size_t>(graph.edges[i].target)].push_back(static_cast<int>(i));
  }
  const std::vector<int> none(num_nodes, -1);
  Search search{{}, none, none, none, none};
  for (size_t node = 0; node < num_nodes; ++node)
    if (search.place[node] < 0) SearchFrom(static_cast<int>(node), graph, edges_of_node, search);
  return search;
}

// A part of the graph and the edges between it and the rest.
class Part {
 public:
  Part(int node, const PoseGraph& graph, const Search& search)
      : graph_(graph),
        search_(search),
        begin_(search.place[static_cast<size_t>(node)]),
        end_(search.end[static_cast<size_t>(node)]) {
    for (size_t i = 0; i < graph.edges.size(); ++i)
      if (Has(graph.edges[i].source) != Has(graph.edges[i].target)) crossing_.push_back(static_cast<int>(i));
  }

  bool MoveToBetterPlace(double squared_scale, const SquaredErrorOfEdge& squared_error,
                         std::vector<RigidTransform>& T_graph_node) const {
    constexpr double kLeastGain = 1.0;
    RigidTransform T_best_old = RigidTransform::Identity();
    const double before = Cost(T_best_old, squared_scale, squared_error, T_graph_node);
    double least = before;
    for (const int edge : crossing_) {
      const RigidTransform T_new_old = MoveAskedBy(graph_.edges[static_cast<size_t>(edge)], T_graph_node);
      const double cost = Cost(T_new_old, squared_scale, squared_error, T_graph_node);
      if (cost >= std::min(least, before - kLeastGain)) continue;
      least = cost;
      T_best_old = T_new_old;
    }
    if (least == before) return false;
    for (int i = begin_; i < end_; ++i) {
      RigidTransform& T = T_graph_node[static_cast<size_t>(search_.order[static_cast<size_t>(i)])];
      T = Orthonormalised(T_best_old * T);
    }
    return true;
  }

 private:
  bool Has(int node) const {
    const int place = search_.place[static_cast<size_t>(node)];
    return begin_ <= place && place < end_;
  }

  RigidTransform MoveAskedBy(const PoseGraphEdge& edge, const std::vector<RigidTransform>& T_graph_node) const {
    const RigidTransform& T_graph_source = T_graph_node[static_cast<size_t>(edge.source)];
    const RigidTransform& T_graph_target = T_graph_node[static_cast<size_t>(edge.target)];
    const RigidTransform T_asked_source = T_graph_target * edge.T_target_source * T_graph_source.inverse();
    return Has(edge.source) ? T_asked_source : T_asked_source.inverse();
  }

  // Over the edges to the rest, were the part moved by `T_new_old`.
  double Cost(const RigidTransform& T_new_old, double squared_scale, const SquaredErrorOfEdge& squared_error,
              const std::vector<RigidTransform>& T_graph_node) const {
    double cost = 0.0;
    for (const int index : crossing_) {
      const PoseGraphEdge& edge = graph_.edges[static_cast<size_t>(index)];
      const RigidTransform& T_graph_source = T_graph_node[static_cast<size_t>(edge.source)];
      const RigidTransform& T_graph_target = T_graph_node[static_cast<size_t>(edge.target)];
      const double square = Has(edge.source) ? squared_error(index, T_new_old * T_graph_source, T_graph_target)
                                             : squared_error(index, T_graph_source, T_new_old * T_graph_target);
      cost += KernelCost(square, squared_scale);
    }
    return cost;
  }

  const PoseGraph& graph_;
  const Search& search_;
  const int begin_, end_;  // in search_.order
  std::vector<int> crossing_;
};

}  // namespace

std::vector<bool> HeaviestForest(const PoseGraph& graph, const std::vector<double>& weights) {
  std::vector<size_t> heaviest_first(weights.size());
  std::iota(heaviest_first.begin(), heaviest_first.end(), size_t{0});
  std::stable_sort(heaviest_first.begin(), heaviest_first.end(),
                   [&](size_t a, size_t b) { return weights[a] > weights[b]; });
  std::vector<bool> is_in(weights.size());
  ConnectedNodes connected(graph.T_graph_node.size());
  for (const size_t i : heaviest_first) is_in[i] = connected.Join(graph.edges[i].source, graph.edges[i].target);
  return is_in;
}

bool MoveParts(const PoseGraph& graph, const std::vector<double>& weights, double squared_scale,
               const SquaredErrorOfEdge& squared_error, std::vector<RigidTransform>& T_graph_node) {
  const Search search = SearchAlong(graph, HoldingEdges(graph, weights));
  bool moved = false;
  for (const int node : search.order) {
    const auto i = static_cast<size_t>(node);
    const bool hangs_on_one_edge = search.parent_edge[i] >= 0 && search.highest[i] == search.place[i];
    if (hangs_on_one_edge && Part(node, graph, search).MoveToBetterPlace(squared_scale, squared_error, T_graph_node))
      moved = true;
  }
  return moved;
}

}  // namespace curvereg
