// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/loop_candidates.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/mapping/link_registration.h"
#include "core/mapping/pose_uncertainty.h"

namespace curvereg {
namespace {

using Pair = std::pair<uint64_t, uint64_t>;  // source, target

bool IsNearer(const PairCandidate& a, const PairCandidate& b) {
  if (a.distance_m != b.distance_m) return a.distance_m < b.distance_m;
  return Pair(a.source, a.target) < Pair(b.source, b.target);
}

double DistanceOf(const TrajectoryPose& a, const TrajectoryPose& b) {
  return (a.T_segment_scan.translation() - b.T_segment_scan.translation()).norm();
}

// Standard deviation of each position in its direction of most doubt; 0 where nothing is known.
std::vector<double> PositionSigmas(const Traverse& traverse) {
  std::vector<double> sigmas;
  for (const TrajectoryPose& pose : traverse.poses) {
    if (!pose.covariance.has_value()) {
      sigmas.push_back(0.0);
      continue;
    }
    const Eigen::Matrix3d covariance = PositionCovariance(pose.T_segment_scan, *pose.covariance);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
    sigmas.push_back(std::sqrt(std::max(0.0, solver.eigenvalues()[2])));
  }
  return sigmas;
}

std::vector<PairCandidate> PairsWithinReach(const Traverse& traverse, const TrackingOptions& options) {
  std::set<Pair> linked;
  for (const TraverseLink& link : traverse.links) linked.emplace(link.source, link.target);
  const std::vector<double> sigmas = PositionSigmas(traverse);
  const auto gap = static_cast<size_t>(std::max(1, options.min_loop_gap));
  std::vector<PairCandidate> pairs;
  for (size_t source = gap; source < traverse.poses.size(); ++source) {
    for (size_t target = 0; target + gap <= source; ++target) {
      if (traverse.poses[source].segment != traverse.poses[target].segment) continue;
      const double distance_m = DistanceOf(traverse.poses[source], traverse.poses[target]);
      const double reach_m = options.loop_distance_m + 3.0 * std::hypot(sigmas[source], sigmas[target]);
      if (distance_m <= reach_m && !linked.contains({source, target})) pairs.push_back({source, target, distance_m});
    }
  }
  std::sort(pairs.begin(), pairs.end(), IsNearer);
  return pairs;
}

// Ends within three scans of each other's: they tie the same two stretches of the path together.
bool Repeats(const PairCandidate& candidate, const Pair& other) {
  constexpr uint64_t kSameStretch = 3;
  const auto gap = [](uint64_t a, uint64_t b) { return std::max(a, b) - std::min(a, b); };
  return gap(candidate.source, other.first) <= kSameStretch && gap(candidate.target, other.second) <= kSameStretch;
}

}  // namespace

std::vector<PairCandidate> FindNeighbourCandidates(const Traverse& traverse, uint64_t sequence_number,
                                                   const TrackingOptions& options) {
  const TrajectoryPose& pose = traverse.poses[sequence_number];
  const std::set<uint64_t> partners = LinkedPartners(traverse, sequence_number);
  std::vector<PairCandidate> candidates;
  for (const TrajectoryPose& other : traverse.poses) {
    const uint64_t number = other.sequence_number;
    if (number == sequence_number || other.segment != pose.segment || partners.contains(number)) continue;
    const double distance_m = DistanceOf(pose, other);
    if (distance_m > options.max_neighbour_distance_m) continue;
    candidates.push_back({std::max(number, sequence_number), std::min(number, sequence_number), distance_m});
  }
  std::sort(candidates.begin(), candidates.end(), IsNearer);
  const auto most = static_cast<size_t>(std::max(0, options.num_neighbours));
  if (candidates.size() > most) candidates.resize(most);
  return candidates;
}

std::vector<PairCandidate> FindLoopCandidates(const Traverse& traverse, const TrackingOptions& options) {
  std::vector<Pair> taken;
  for (const TraverseLink& link : traverse.links) {
    if (link.result.verdict.accepted && link.source - link.target >= static_cast<uint64_t>(options.min_loop_gap)) {
      taken.emplace_back(link.source, link.target);
    }
  }
  const auto most = static_cast<size_t>(std::max(0, options.max_loop_candidates));
  std::vector<PairCandidate> chosen;
  std::vector<PairCandidate> repeating;
  for (const PairCandidate& candidate : PairsWithinReach(traverse, options)) {
    if (chosen.size() == most) return chosen;
    const bool repeats =
        std::any_of(taken.begin(), taken.end(), [&](const Pair& other) { return Repeats(candidate, other); });
    if (repeats) {
      if (repeating.size() < most) repeating.push_back(candidate);
      continue;
    }
    chosen.push_back(candidate);
    taken.emplace_back(candidate.source, candidate.target);
  }
  repeating.resize(std::min(repeating.size(), most - chosen.size()));
  chosen.insert(chosen.end(), repeating.begin(), repeating.end());
  return chosen;
}

}  // namespace curvereg
