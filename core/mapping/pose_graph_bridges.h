// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Parts of a pose graph that are connected by a single edge of full weight. Least squares cannot detect that such an
// edge is wrong, because its residual is zero. It is likely to be wrong when rejected edges join the same two parts and
// agree with each other on another place.
#ifndef CURVEREG_CORE_MAPPING_POSE_GRAPH_BRIDGES_H_
#define CURVEREG_CORE_MAPPING_POSE_GRAPH_BRIDGES_H_

#include <functional>
#include <vector>

#include "core/mapping/pose_graph.h"

namespace curvereg {

// Of each edge: whether it is in the spanning forest of the greatest weight; of equal ones the first.
std::vector<bool> HeaviestForest(const PoseGraph& graph, const std::vector<double>& weights);

// Squared length, in standard deviations, of the error of the edge of that index between two poses.
using SquaredErrorOfEdge =
    std::function<double(int edge, const RigidTransform& T_graph_source, const RigidTransform& T_graph_target)>;

// Moves one part after the other, as a body, to where a rejected edge places it, if that lowers the sum of
// KernelCost over the edges between the part and the rest. `weights`: of the edges at these poses. The first
// node of each component stays. Returns whether any part was moved.
bool MoveParts(const PoseGraph& graph, const std::vector<double>& weights, double squared_scale,
               const SquaredErrorOfEdge& squared_error, std::vector<RigidTransform>& T_graph_node);

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_POSE_GRAPH_BRIDGES_H_
