// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/revise_traverse.h"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "core/mapping/pose_graph_start.h"
#include "core/mapping/pose_uncertainty.h"
#include "core/mapping/segment_joins.h"

namespace curvereg {
namespace {

// The graph of a traverse and where its edges come from.
struct TraverseGraph {
  PoseGraph graph;
  std::vector<size_t> link_of_edge;  // index in Traverse::links of the first edges; the edges after them are priors
};

TraverseGraph MakeGraph(const Traverse& traverse, const SegmentPlaces& places, const std::set<size_t>& excluded_links,
                        const PoseGraphOptions& options) {
  TraverseGraph made;
  for (const TrajectoryPose& pose : traverse.poses) {
    made.graph.T_graph_node.push_back(places.at(pose.segment).T_root_segment * pose.T_segment_scan);
  }
  const auto root_of = [&](uint64_t number) { return places.at(traverse.poses[number].segment).root; };
  for (size_t i = 0; i < traverse.links.size(); ++i) {
    const TraverseLink& link = traverse.links[i];
    if (!link.result.verdict.accepted || excluded_links.contains(i)) continue;
    if (root_of(link.source) != root_of(link.target)) continue;
    made.graph.edges.push_back({static_cast<int>(link.source), static_cast<int>(link.target),
                                *link.result.T_target_source, LinkCovariance(link.result, options)});
    made.link_of_edge.push_back(i);
  }
  // Wheels slip, so odometry may be wrong as well. Where there is nothing else, it decides nevertheless.
  for (size_t number = 1; number < traverse.poses.size(); ++number) {
    const std::optional<Prior>& prior = traverse.priors[number];
    if (!prior.has_value() || !prior->covariance.has_value()) continue;
    if (traverse.poses[number].segment != traverse.poses[number - 1].segment) continue;
    made.graph.edges.push_back(
        {static_cast<int>(number), static_cast<int>(number) - 1, prior->T_target_source, *prior->covariance});
  }
  return made;
}

// Without a cycle every edge holds exactly, so there is nothing to weigh up.
bool HasCycle(const PoseGraph& graph) {
  ConnectedNodes connected(graph.T_graph_node.size());
  for (const PoseGraphEdge& edge : graph.edges) {
    if (!connected.Join(edge.source, edge.target)) return true;
  }
  return false;
}

bool DiffersInSigma(const Matrix6d& before, const Matrix6d& after) {
  constexpr double kRelative = 0.01;
  const Eigen::Array<double, 6, 1> old_sigmas = before.diagonal().array().max(0.0).sqrt();
  const Eigen::Array<double, 6, 1> sigmas = after.diagonal().array().max(0.0).sqrt();
  return ((sigmas - old_sigmas).abs() > kRelative * old_sigmas + 1e-6).any();
}

bool Differs(const TrajectoryPose& before, const TrajectoryPose& after) {
  constexpr double kMovedM = 1e-4;
  constexpr double kMovedRad = 1e-5;
  if (before.segment != after.segment || before.origin != after.origin) return true;
  const TransformDifference moved = Difference(before.T_segment_scan, after.T_segment_scan);
  if (moved.translation_m > kMovedM || moved.rotation_rad > kMovedRad) return true;
  if (before.covariance.has_value() != after.covariance.has_value()) return true;
  return before.covariance.has_value() && DiffersInSigma(*before.covariance, *after.covariance);
}

class TraverseReviser {
 public:
  TraverseReviser(const Traverse& traverse, const TrackingOptions& options, const Stop& stop)
      : traverse_(traverse), options_(options), stop_(stop) {}

  absl::StatusOr<TraverseRevision> Run() {
    if (traverse_.poses.empty()) return TraverseRevision{};
    if (absl::Status status = Optimise(); !status.ok()) return status;
    revision_.converged = !is_optimised_ || optimised_.converged;
    CountLinks();
    FillPoses();
    FillJoins();
    return std::move(revision_);
  }

 private:
  // Segments are joined by links that the optimisation may then give up; without these once more, until all joins hold.
  absl::Status Optimise() {
    PoseGraphOptions options = options_.pose_graph;
    options.with_covariances = false;  // of the last round only
    while (true) {
      places_ = PlaceSegments(traverse_, excluded_links_);
      made_ = MakeGraph(traverse_, places_, excluded_links_, options_.pose_graph);
      optimised_ = PoseGraphResult{};
      optimised_.T_graph_node = made_.graph.T_graph_node;
      optimised_.edge_weights.assign(made_.graph.edges.size(), 1.0);
      is_optimised_ = HasCycle(made_.graph) || HasJoins();
      if (!is_optimised_) return absl::OkStatus();
      absl::StatusOr<PoseGraphResult> optimised = OptimizePoseGraph(made_.graph, options, stop_);
      if (!optimised.ok()) return optimised.status();
      optimised_ = *std::move(optimised);
      std::set<size_t> excluded = excluded_links_;
      for (size_t edge = 0; edge < made_.link_of_edge.size(); ++edge) {
        const size_t link = made_.link_of_edge[edge];
        if (optimised_.edge_weights[edge] < kGivenUpWeight && JoinsSegments(traverse_, link)) excluded.insert(link);
      }
      const bool holds = SameJoins(places_, PlaceSegments(traverse_, excluded));
      if (holds) return FindCovariances();
      excluded_links_ = std::move(excluded);
    }
  }

  absl::Status FindCovariances() {
    if (!options_.pose_graph.with_covariances) return absl::OkStatus();
    auto covariances = PoseGraphCovariances(made_.graph, optimised_, options_.pose_graph, stop_);
    if (covariances.ok()) optimised_.covariances = *std::move(covariances);
    return covariances.status();
  }

  bool HasJoins() const {
    return std::any_of(places_.begin(), places_.end(),
                       [](const auto& place) { return place.first != place.second.root; });
  }

  void CountLinks() {
    revision_.num_rejected_links = static_cast<int>(excluded_links_.size());
    for (size_t edge = 0; edge < made_.link_of_edge.size(); ++edge) {
      const bool is_given_up = optimised_.edge_weights[edge] < kGivenUpWeight;
      ++(is_given_up ? revision_.num_rejected_links : revision_.num_links);
    }
  }

  // How each pose came about that is not the first of its segment.
  std::vector<PoseOrigin> Origins() const {
    ConnectedNodes linked(traverse_.poses.size());
    std::vector<bool> has_prior(traverse_.poses.size(), false);
    for (size_t i = 0; i < made_.graph.edges.size(); ++i) {
      const PoseGraphEdge& edge = made_.graph.edges[i];
      if (i >= made_.link_of_edge.size()) {
        has_prior[static_cast<size_t>(edge.source)] = true;
      } else if (optimised_.edge_weights[i] >= kGivenUpWeight) {
        linked.Join(edge.source, edge.target);
      }
    }
    std::vector<PoseOrigin> origins;
    for (size_t i = 0; i < traverse_.poses.size(); ++i) {
      const auto node = static_cast<int>(i);
      const bool by_prior = linked.First(node) == node && has_prior[i];
      origins.push_back(by_prior ? PoseOrigin::kPrior : PoseOrigin::kRegistered);
    }
    return origins;
  }

  void FillPoses() {
    const std::vector<PoseOrigin> origins = Origins();
    std::set<int> begun;  // segments whose first pose was seen
    for (size_t i = 0; i < traverse_.poses.size(); ++i) {
      const TrajectoryPose& before = traverse_.poses[i];
      TrajectoryPose after = before;
      after.segment = places_.at(before.segment).root;
      const bool is_first = begun.insert(after.segment).second;
      if (!is_first) after.origin = origins[i];
      if (is_optimised_) {
        after.T_segment_scan = optimised_.T_graph_node[i];
        if (!optimised_.covariances.empty()) after.covariance = optimised_.covariances[i];
      }
      if (!Differs(before, after)) continue;
      if (after.segment == before.segment) {
        const double moved_m = (after.T_segment_scan.translation() - before.T_segment_scan.translation()).norm();
        revision_.max_translation_change_m = std::max(revision_.max_translation_change_m, moved_m);
      }
      revision_.poses.push_back(after);
    }
  }

  void FillJoins() {
    std::set<int> begun;
    for (size_t i = 0; i < traverse_.poses.size(); ++i) {
      const TrajectoryPose& first = traverse_.poses[i];
      const int root = places_.at(first.segment).root;
      if (!begun.insert(first.segment).second || root == first.segment) continue;
      revision_.joins.push_back({root, first.segment, optimised_.T_graph_node[i] * first.T_segment_scan.inverse()});
    }
  }

  const Traverse& traverse_;
  const TrackingOptions& options_;
  const Stop& stop_;
  std::set<size_t> excluded_links_;  // accepted, but wrong joins of segments
  SegmentPlaces places_;
  TraverseGraph made_;
  PoseGraphResult optimised_;
  bool is_optimised_ = false;
  TraverseRevision revision_;
};

}  // namespace

absl::StatusOr<TraverseRevision> ReviseTraverse(const Traverse& traverse, const TrackingOptions& options,
                                                const Stop& stop) {
  return TraverseReviser(traverse, options, stop).Run();
}

}  // namespace curvereg
