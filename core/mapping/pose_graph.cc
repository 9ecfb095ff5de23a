// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/pose_graph.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "core/mapping/pose_graph_least_squares.h"
#include "core/mapping/pose_graph_start.h"
#include "core/parallel.h"

namespace curvereg {
namespace {

absl::Status CheckEdge(const PoseGraphEdge& edge, size_t num_nodes) {
  const auto names_node = [&](int node) { return node >= 0 && static_cast<size_t>(node) < num_nodes; };
  if (!names_node(edge.source) || !names_node(edge.target)) return absl::InvalidArgumentError("names no node");
  if (edge.source == edge.target) return absl::InvalidArgumentError("names one node twice");
  if (!IsRigid(edge.T_target_source)) return absl::InvalidArgumentError("is not a rigid transform");
  const double asymmetry = (edge.covariance - edge.covariance.transpose()).cwiseAbs().maxCoeff();
  if (!edge.covariance.allFinite() || !(asymmetry <= 1e-6 * edge.covariance.cwiseAbs().maxCoeff()) ||
      Eigen::LLT<Matrix6d>(edge.covariance).info() != Eigen::Success)
    return absl::InvalidArgumentError("has a covariance that is not positive definite");
  return absl::OkStatus();
}

absl::Status Check(const PoseGraph& graph, const PoseGraphOptions& options) {
  if (!(options.kernel_sigmas > 0.0) || !(options.least_sigma_rad > 0.0) || !(options.least_sigma_m > 0.0) ||
      options.max_iterations < 1 || options.num_threads < 0)
    return absl::InvalidArgumentError("pose graph options must be positive");
  for (size_t i = 0; i < graph.T_graph_node.size(); ++i)
    if (!IsRigid(graph.T_graph_node[i]))
      return absl::InvalidArgumentError("the pose of node " + std::to_string(i) + " is not rigid");
  for (size_t i = 0; i < graph.edges.size(); ++i) {
    const absl::Status status = CheckEdge(graph.edges[i], graph.T_graph_node.size());
    if (!status.ok())
      return absl::InvalidArgumentError("edge " + std::to_string(i) + " " + std::string(status.message()));
  }
  return absl::OkStatus();
}

// Of the kernel of squared scale c^2: (c^2 / (r^2 + c^2))^2.
std::vector<double> KernelWeights(const std::vector<double>& squared_errors, double squared_scale,
                                  const PoseGraph& graph) {
  std::vector<double> weights;
  for (size_t i = 0; i < squared_errors.size(); ++i) {
    const double root = squared_scale / (squared_errors[i] + squared_scale);
    weights.push_back(graph.edges[i].may_be_wrong ? root * root : 1.0);
  }
  return weights;
}

// Lifts the weights of a spanning forest of the heaviest edges to kLeastHold, so that no part of the graph that only
// edges given up hold floats away. Forests have no cycles: what is lifted pulls at nothing.
std::vector<double> WithHold(std::vector<double> weights, const PoseGraph& graph) {
  constexpr double kLeastHold = 1e-6;
  std::vector<size_t> heaviest_first(weights.size());
  std::iota(heaviest_first.begin(), heaviest_first.end(), size_t{0});
  std::stable_sort(heaviest_first.begin(), heaviest_first.end(),
                   [&](size_t a, size_t b) { return weights[a] > weights[b]; });
  ConnectedNodes connected(graph.T_graph_node.size());
  for (const size_t i : heaviest_first)
    if (connected.Join(graph.edges[i].source, graph.edges[i].target)) weights[i] = std::max(weights[i], kLeastHold);
  return weights;
}

// In each component the poses given or those through edges that others confirm, whichever suit the edges better. Errors
// count by their logarithm here: one wrong edge far away must not outweigh hundreds that fit.
std::vector<RigidTransform> BetterStart(const PoseGraph& graph, const PoseGraphOptions& options,
                                        PoseGraphLeastSquares& problem) {
  const std::vector<int> first = FirstNodes(graph);
  const double squared_scale = options.kernel_sigmas * options.kernel_sigmas;
  std::vector<RigidTransform> start = PosesThroughSupportedEdges(graph, options);
  const std::vector<double> given_errors = problem.SquaredErrors();
  problem.SetPoses(start);
  const std::vector<double> start_errors = problem.SquaredErrors();
  std::vector<double> gain(first.size(), 0.0);
  for (size_t i = 0; i < start_errors.size(); ++i)
    gain[static_cast<size_t>(first[static_cast<size_t>(graph.edges[i].source)])] +=
        std::log1p(given_errors[i] / squared_scale) - std::log1p(start_errors[i] / squared_scale);
  for (size_t i = 0; i < first.size(); ++i)
    if (gain[static_cast<size_t>(first[i])] < 0.0) start[i] = graph.T_graph_node[i];
  return start;
}

// The largest move of a pose, in the least deviations that options allow.
double LargestMove(const std::vector<RigidTransform>& before, const std::vector<RigidTransform>& after,
                   const PoseGraphOptions& options) {
  double largest = 0.0;
  for (size_t i = 0; i < before.size(); ++i) {
    const TransformDifference move = Difference(before[i], after[i]);
    largest =
        std::max({largest, move.rotation_rad / options.least_sigma_rad, move.translation_m / options.least_sigma_m});
  }
  return largest;
}

// Graduated non-convexity. The kernel starts so blunt (scale sqrt(mu) c) that the sum is convex in the errors, and gets
// sharper with every step of the least squares that are re-weighted to it.
absl::Status Graduate(const PoseGraph& graph, const PoseGraphOptions& options, const Stop& stop,
                      PoseGraphLeastSquares& problem, PoseGraphResult& result) {
  constexpr double kSharpening = 2.0;
  constexpr double kStill = 0.01;  // of a least deviation
  const double squared_scale = options.kernel_sigmas * options.kernel_sigmas;
  std::vector<double> squared_errors = problem.SquaredErrors();
  result.converged = squared_errors.empty();
  double mu = 1.0;
  if (!squared_errors.empty())
    mu = std::max(1.0, 2.0 * *std::max_element(squared_errors.begin(), squared_errors.end()) / squared_scale);
  while (!result.converged && result.iterations < options.max_iterations) {
    const std::vector<RigidTransform> before = problem.poses();
    const absl::Status status =
        problem.Improve(WithHold(KernelWeights(squared_errors, mu * squared_scale, graph), graph), stop);
    if (!status.ok()) return status;
    ++result.iterations;
    squared_errors = problem.SquaredErrors();
    result.converged = mu == 1.0 && LargestMove(before, problem.poses(), options) <= kStill;
    mu = std::max(1.0, mu / kSharpening);
  }
  result.edge_weights = KernelWeights(squared_errors, squared_scale, graph);
  return absl::OkStatus();
}

absl::StatusOr<PoseGraphResult> Optimize(const PoseGraph& graph, const PoseGraphOptions& options, const Stop& stop) {
  PoseGraphLeastSquares problem(graph, options);
  problem.SetPoses(BetterStart(graph, options, problem));
  PoseGraphResult result;
  const absl::Status status = Graduate(graph, options, stop, problem, result);
  if (!status.ok()) return status;
  if (options.with_covariances) {
    auto covariances = problem.Covariances(WithHold(result.edge_weights, graph), stop);
    if (!covariances.ok()) return covariances.status();
    result.covariances = *std::move(covariances);
  }
  result.T_graph_node = problem.poses();
  return result;
}

}  // namespace

absl::StatusOr<PoseGraphResult> OptimizePoseGraph(const PoseGraph& graph, const PoseGraphOptions& options,
                                                  const Stop& stop) {
  const absl::Status status = Check(graph, options);
  if (!status.ok()) return status;
  absl::StatusOr<PoseGraphResult> result = absl::InternalError("not run");
  WithThreadLimit(options.num_threads, [&] { result = Optimize(graph, options, stop); });
  return result;
}

}  // namespace curvereg
