// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Pose graph: the poses that agree best with all measured transforms between them, in spite of some that are wrong.
#ifndef CURVEREG_CORE_MAPPING_POSE_GRAPH_H_
#define CURVEREG_CORE_MAPPING_POSE_GRAPH_H_

#include <vector>

#include "absl/status/statusor.h"
#include "core/base/rigid_transform.h"
#include "core/base/stop.h"

namespace curvereg {

// A measured transform between two nodes.
struct PoseGraphEdge {
  int source = 0;  // index of a node
  int target = 0;
  RigidTransform T_target_source = RigidTransform::Identity();
  Matrix6d covariance = Matrix6d::Identity();  // of (rotation [rad], translation [m]), left perturbation, target frame
};

struct PoseGraph {
  std::vector<RigidTransform> T_graph_node;  // first guesses
  std::vector<PoseGraphEdge> edges;
};

struct PoseGraphOptions {
  // Geman-McClure scale in standard deviations of an edge: far beyond it an edge counts for nothing.
  double kernel_sigmas = 5.0;
  // Floors of the standard deviations: the covariances of registrations are too small, see docs/method.md.
  double least_sigma_rad = 1e-4;
  double least_sigma_m = 2e-3;
  int max_iterations = 100;  // of one graduation; there are up to eight where edges are given up
  bool with_covariances = true;
  int num_threads = 0;  // 0: one per processor
};

// An edge of less weight counts as rejected: with the default scale its error is some nine standard deviations, which
// noise does not reach.
inline constexpr double kGivenUpWeight = 0.05;

struct PoseGraphResult {
  std::vector<RigidTransform> T_graph_node;  // node 0 of each connected component stays where it was
  // Of (rotation, translation), left perturbation, graph frame, relative to the component's first node; empty unless
  // with_covariances.
  std::vector<Matrix6d> covariances;
  std::vector<double> edge_weights;  // in [0, 1]: 1: full weight; below kGivenUpWeight: rejected
  int iterations = 0;                // of all graduations
  bool converged = false;            // whether the poses held still at the end of the best one
};

// Graduated non-convexity: starts with full weight for all edges and sharpens the kernel step by step, so that the
// start need not be near [H. Yang, P. Antonante, V. Tzoumas, L. Carlone, "Graduated Non-Convexity for Robust Spatial
// Perception", IEEE RA-L 5(2), 2020]. The first node of each connected component is held. INVALID_ARGUMENT: an edge
// names no node or one node twice, is not rigid, or its covariance is not positive definite, or a number is too large
// to compute with; FAILED_PRECONDITION: covariances so far apart that a pose is not determined; CANCELLED; out of time:
// DEADLINE_EXCEEDED.
absl::StatusOr<PoseGraphResult> OptimizePoseGraph(const PoseGraph& graph, const PoseGraphOptions& options = {},
                                                  const Stop& stop = {});

// PoseGraphResult::covariances of a result without them, for the graph and options that gave it. Errors as
// OptimizePoseGraph.
absl::StatusOr<std::vector<Matrix6d>> PoseGraphCovariances(const PoseGraph& graph, const PoseGraphResult& result,
                                                           const PoseGraphOptions& options, const Stop& stop = {});

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_POSE_GRAPH_H_
