// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Where a pose graph's optimisation starts: poses chained through edges that other edges confirm. Three edges that
// close a triangle confirm each other when going round it leads back to where one started; wrong ones hardly ever do.
#ifndef CURVEREG_CORE_MAPPING_POSE_GRAPH_START_H_
#define CURVEREG_CORE_MAPPING_POSE_GRAPH_START_H_

#include <cstddef>
#include <vector>

#include "core/mapping/pose_graph.h"

namespace curvereg {

// Groups of nodes that edges join, one after the other.
class ConnectedNodes {
 public:
  explicit ConnectedNodes(std::size_t num_nodes);
  int First(int node);            // the lowest index in the node's group
  bool Join(int one, int other);  // false: they were joined already

 private:
  std::vector<int> towards_first_;
};

// For each node the lowest index in its connected component: the component's first node.
std::vector<int> FirstNodes(const PoseGraph& graph);

// Of an edge: the cycles of two and three edges that it closes with its neighbours, some tens at most.
struct EdgeSupport {
  int num_cycles = 0;
  int num_consistent = 0;  // came back within kernel_sigmas
};
std::vector<EdgeSupport> FindEdgeSupport(const PoseGraph& graph, const PoseGraphOptions& options);

// The poses along the paths of least variance from each component's first node, where an edge that its cycles
// contradict, or that is in no cycle, gets a length so much larger that it is used only where there is no other.
std::vector<RigidTransform> PosesThroughSupportedEdges(const PoseGraph& graph, const PoseGraphOptions& options);

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_POSE_GRAPH_START_H_
