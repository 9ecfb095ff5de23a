// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/pose_graph.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "core/base/parallel.h"
#include "core/mapping/pose_graph_bridges.h"
#include "core/mapping/pose_graph_kernel.h"
#include "core/mapping/pose_graph_least_squares.h"
#include "core/mapping/pose_graph_start.h"

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

std::vector<double> KernelWeights(const std::vector<double>& squared_errors, double squared_scale) {
  std::vector<double> weights;
  for (const double squared_error : squared_errors) weights.push_back(KernelWeight(squared_error, squared_scale));
  return weights;
}

// Lifts the weights of HeaviestForest to kLeastHold, so that no part of the graph that only edges given up hold floats
// away. Forests have no cycles: what is lifted pulls at nothing.
std::vector<double> WithHold(std::vector<double> weights, const PoseGraph& graph) {
  constexpr double kLeastHold = 1e-6;
  const std::vector<bool> holds = HeaviestForest(graph, weights);
  for (size_t i = 0; i < weights.size(); ++i)
    if (holds[i]) weights[i] = std::max(weights[i], kLeastHold);
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

struct Graduation {
  std::vector<RigidTransform> T_graph_node;
  std::vector<double> squared_errors;
  double cost = 0.0;  // sum of KernelCost
  int iterations = 0;
  bool converged = false;
};

double RobustCost(const std::vector<double>& squared_errors, double squared_scale) {
  double cost = 0.0;
  for (const double squared_error : squared_errors) cost += KernelCost(squared_error, squared_scale);
  return cost;
}

// Graduated non-convexity from the problem's poses: the kernel starts with the scale sqrt(mu) c and gets sharper with
// every step of the least squares that are re-weighted to it, until it has the scale c.
absl::StatusOr<Graduation> Graduate(const PoseGraph& graph, const PoseGraphOptions& options, double mu,
                                    PoseGraphLeastSquares& problem) {
  constexpr double kSharpening = 2.0;
  constexpr double kVeryBlunt = 100.0;  // where little depends on the kernel
  constexpr double kStill = 0.01;       // of a least deviation
  const double squared_scale = options.kernel_sigmas * options.kernel_sigmas;
  Graduation result;
  result.squared_errors = problem.SquaredErrors();
  while (!result.converged && result.iterations < options.max_iterations) {
    const std::vector<RigidTransform> before = problem.poses();
    const absl::Status status =
        problem.Improve(WithHold(KernelWeights(result.squared_errors, mu * squared_scale), graph));
    if (!status.ok()) return status;
    ++result.iterations;
    result.squared_errors = problem.SquaredErrors();
    result.converged = mu == 1.0 && LargestMove(before, problem.poses(), options) <= kStill;
    mu = std::max(1.0, mu / (mu > kVeryBlunt ? kSharpening * kSharpening : kSharpening));
  }
  result.T_graph_node = problem.poses();
  result.cost = RobustCost(result.squared_errors, squared_scale);
  return result;
}

constexpr double kMost = 0.8;  // of the edges

// The mu from which on the kernel is convex for this part of the edges.
double ConvexFor(double part, std::vector<double> squared_errors, const PoseGraphOptions& options) {
  const auto rank = static_cast<std::ptrdiff_t>(part * static_cast<double>(squared_errors.size() - 1));
  std::nth_element(squared_errors.begin(), squared_errors.begin() + rank, squared_errors.end());
  return std::max(1.0,
                  2.0 * squared_errors[static_cast<size_t>(rank)] / (options.kernel_sigmas * options.kernel_sigmas));
}

// Graduates again from where MoveParts would have parts of the graph, if anywhere.
absl::StatusOr<Graduation> WithPartsMoved(Graduation best, const PoseGraph& graph, const PoseGraphOptions& options,
                                          PoseGraphLeastSquares& problem) {
  constexpr int kMaxRounds = 3;
  const double squared_scale = options.kernel_sigmas * options.kernel_sigmas;
  for (int round = 0; round < kMaxRounds; ++round) {
    std::vector<RigidTransform> T_graph_node = best.T_graph_node;
    const auto squared_error = [&](int edge, const RigidTransform& T_graph_source,
                                   const RigidTransform& T_graph_target) {
      return problem.SquaredError(edge, T_graph_source, T_graph_target);
    };
    if (!MoveParts(graph, KernelWeights(best.squared_errors, squared_scale), squared_scale, squared_error,
                   T_graph_node))
      break;
    problem.SetPoses(T_graph_node);
    absl::StatusOr<Graduation> next =
        Graduate(graph, options, ConvexFor(kMost, problem.SquaredErrors(), options), problem);
    if (!next.ok()) return next;
    next->iterations += best.iterations;
    best.iterations = next->iterations;
    if (next->cost >= best.cost) break;
    best = *std::move(next);
  }
  return best;
}

// The first graduation trusts the start: edges far from it have no say at first. Where it gives edges up, the start may
// be to blame, and a second one begins with a kernel that is convex for all; the lower cost wins.
absl::StatusOr<Graduation> BestGraduation(const PoseGraph& graph, const PoseGraphOptions& options,
                                          PoseGraphLeastSquares& problem) {
  const std::vector<RigidTransform> start = BetterStart(graph, options, problem);
  problem.SetPoses(start);
  const std::vector<double> squared_errors = problem.SquaredErrors();
  // Larger numbers would overflow in the products to come.
  if (!std::all_of(squared_errors.begin(), squared_errors.end(), [](double square) { return square < 1e40; }))
    return absl::InvalidArgumentError("the pose graph holds numbers that cannot be computed with");
  absl::StatusOr<Graduation> best = Graduate(graph, options, ConvexFor(kMost, squared_errors, options), problem);
  if (!best.ok()) return best;
  const std::vector<double> weights =
      KernelWeights(best->squared_errors, options.kernel_sigmas * options.kernel_sigmas);
  if (*std::min_element(weights.begin(), weights.end()) >= kGivenUpWeight) return best;
  best = WithPartsMoved(*std::move(best), graph, options, problem);
  if (!best.ok()) return best;
  problem.SetPoses(start);
  absl::StatusOr<Graduation> second = Graduate(graph, options, ConvexFor(1.0, squared_errors, options), problem);
  if (!second.ok()) return second;
  second = WithPartsMoved(*std::move(second), graph, options, problem);
  if (!second.ok()) return second;
  const int iterations = best->iterations + second->iterations;
  if (second->cost < best->cost) best = std::move(second);
  best->iterations = iterations;
  problem.SetPoses(best->T_graph_node);
  return best;
}

absl::StatusOr<PoseGraphResult> Optimize(const PoseGraph& graph, const PoseGraphOptions& options, const Stop& stop) {
  PoseGraphLeastSquares problem(graph, options, stop);
  PoseGraphResult result;
  result.converged = graph.edges.empty();
  if (!graph.edges.empty()) {
    const absl::StatusOr<Graduation> best = BestGraduation(graph, options, problem);
    if (!best.ok()) return best.status();
    result.iterations = best->iterations;
    result.converged = best->converged;
    result.edge_weights = KernelWeights(best->squared_errors, options.kernel_sigmas * options.kernel_sigmas);
  }
  if (options.with_covariances) {
    auto covariances = problem.Covariances(WithHold(result.edge_weights, graph));
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

absl::StatusOr<std::vector<Matrix6d>> PoseGraphCovariances(const PoseGraph& graph, const PoseGraphResult& result,
                                                           const PoseGraphOptions& options, const Stop& stop) {
  if (absl::Status status = Check(graph, options); !status.ok()) return status;
  if (result.T_graph_node.size() != graph.T_graph_node.size() || result.edge_weights.size() != graph.edges.size())
    return absl::InvalidArgumentError("the result is of another pose graph");
  absl::StatusOr<std::vector<Matrix6d>> covariances = absl::InternalError("not run");
  WithThreadLimit(options.num_threads, [&] {
    PoseGraphLeastSquares problem(graph, options, stop);
    problem.SetPoses(result.T_graph_node);
    covariances = problem.Covariances(WithHold(result.edge_weights, graph));
  });
  return covariances;
}

}  // namespace curvereg
