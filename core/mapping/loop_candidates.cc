// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/loop_candidates.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <utility>
#include <vector>

#include "core/base/small_matrices.h"
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
    sigmas.push_back(std::sqrt(std::max(0.0, EigenvaluesOf(covariance)[2])));
  }
  return sigmas;
}

uint64_t LoopGap(const TrackingOptions& options) { return static_cast<uint64_t>(std::max(1, options.min_loop_gap)); }

// A rover that stands still, or does not know where it is, has all its scans within reach of each other.
constexpr size_t kMostOfOneScan = 100;

void KeepNearest(size_t most, std::vector<PairCandidate>& pairs) {
  if (pairs.size() <= most) return;
  std::nth_element(pairs.begin(), pairs.begin() + static_cast<std::ptrdiff_t>(most), pairs.end(), IsNearer);
  pairs.resize(most);
}

std::vector<PairCandidate> PairsWithinReach(const Traverse& traverse, const TrackingOptions& options) {
  std::set<Pair> linked;
  for (const TraverseLink& link : traverse.links) linked.emplace(link.source, link.target);
  const std::vector<double> sigmas = PositionSigmas(traverse);
  const uint64_t gap = LoopGap(options);
  std::vector<PairCandidate> pairs;
  std::vector<PairCandidate> of_source;
  for (size_t source = gap; source < traverse.poses.size(); ++source) {
    of_source.clear();
    for (size_t target = 0; target + gap <= source; ++target) {
      if (traverse.poses[source].segment != traverse.poses[target].segment) continue;
      const double distance_m = DistanceOf(traverse.poses[source], traverse.poses[target]);
      const double reach_m = options.loop_distance_m + 3.0 * std::hypot(sigmas[source], sigmas[target]);
      if (distance_m > reach_m || linked.contains({source, target})) continue;
      of_source.push_back({source, target, distance_m});
    }
    KeepNearest(kMostOfOneScan, of_source);
    pairs.insert(pairs.end(), of_source.begin(), of_source.end());
  }
  std::sort(pairs.begin(), pairs.end(), IsNearer);
  return pairs;
}

constexpr uint64_t kSameStretch = 3;  // scans

// Loops that were tried or are there already.
class TakenLoops {
 public:
  TakenLoops(const Traverse& traverse, uint64_t least_gap) {
    for (const TraverseLink& link : traverse.links) {
      if (link.result.verdict.accepted && link.source - link.target >= least_gap) Add({link.source, link.target});
    }
  }

  void Add(const Pair& pair) { taken_.insert(pair); }

  // Ends within kSameStretch scans of each other's: they tie the same two stretches of the path together.
  bool IsRepeatedBy(const PairCandidate& candidate) const {
    const auto below = [](uint64_t number) { return number - std::min(number, kSameStretch); };
    for (uint64_t source = below(candidate.source); source <= candidate.source + kSameStretch; ++source) {
      const auto first = taken_.lower_bound({source, below(candidate.target)});
      if (first != taken_.end() && *first <= Pair(source, candidate.target + kSameStretch)) return true;
    }
    return false;
  }

 private:
  std::set<Pair> taken_;
};

}  // namespace

absl::Status TryNeighbours(const Traverse& traverse, uint64_t sequence_number, const TrackingOptions& options,
                           const TryPair& try_pair) {
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
  int num_tried = 0;
  int num_not_kept = 0;
  for (const PairCandidate& candidate : candidates) {
    if (num_tried >= options.num_neighbours || num_not_kept >= kMaxNotKept) break;
    const absl::StatusOr<bool> was_tried = try_pair(candidate);
    if (!was_tried.ok()) return was_tried.status();
    ++(*was_tried ? num_tried : num_not_kept);
  }
  return absl::OkStatus();
}

absl::Status TryLoops(const Traverse& traverse, const TrackingOptions& options, const TryPair& try_pair) {
  TakenLoops taken(traverse, LoopGap(options));
  int num_tried = 0;
  std::vector<PairCandidate> pairs = PairsWithinReach(traverse, options);
  for (const bool also_repeating : {false, true}) {
    std::vector<PairCandidate> repeating;
    for (const PairCandidate& pair : pairs) {
      if (num_tried >= options.max_loop_candidates) return absl::OkStatus();
      if (!also_repeating && taken.IsRepeatedBy(pair)) {
        repeating.push_back(pair);
        continue;
      }
      const absl::StatusOr<bool> was_tried = try_pair(pair);
      if (!was_tried.ok()) return was_tried.status();
      if (!*was_tried) continue;
      ++num_tried;
      taken.Add({pair.source, pair.target});
    }
    pairs = std::move(repeating);
  }
  return absl::OkStatus();
}

}  // namespace curvereg
