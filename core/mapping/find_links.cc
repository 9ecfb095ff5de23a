// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <utility>

#include "core/mapping/link_registration.h"
#include "core/mapping/loop_candidates.h"
#include "core/mapping/place_recognition.h"
#include "core/mapping/pose_uncertainty.h"
#include "core/mapping/tracking.h"

namespace curvereg {
namespace {

class LinkFinder {
 public:
  LinkFinder(const Traverse& traverse, const TraverseScanLoader& load, const TrackingOptions& options, const Stop& stop)
      : traverse_(traverse), load_(load), options_(options), stop_(stop) {}

  std::vector<TraverseLink> Take() { return std::move(links_); }

  // Pairs whose positions are known.
  absl::Status RegisterPairs(const std::vector<PairCandidate>& candidates, LinkKind kind) {
    for (const PairCandidate& candidate : candidates) {
      const Prior relative =
          RelativePose(traverse_.poses[candidate.target], traverse_.poses[candidate.source], RelativeOptions());
      const absl::StatusOr<bool> is_accepted = Register({candidate.source, candidate.target, kind, relative});
      if (!is_accepted.ok()) return is_accepted.status();
    }
    return absl::OkStatus();
  }

  // Places of older segments that look like this scan's, until one is recognised. Uses up `num_tries`.
  absl::Status SearchOlderSegments(uint64_t sequence_number, LinkKind kind, int& num_tries) {
    const std::vector<uint64_t> places =
        PlacesOfOlderSegments(traverse_, sequence_number, options_.max_places_compared);
    if (places.empty() || num_tries <= 0) return absl::OkStatus();
    const absl::StatusOr<std::vector<AlikePlace>> ranked = Ranked(sequence_number, places);
    if (absl::IsNotFound(ranked.status())) return absl::OkStatus();
    if (!ranked.ok()) return ranked.status();
    const std::set<uint64_t> partners = LinkedPartners(traverse_, sequence_number);
    for (const AlikePlace& place : *ranked) {
      if (num_tries <= 0 || place.likeness == 0) break;
      if (partners.contains(place.sequence_number)) continue;
      --num_tries;
      const uint64_t source = std::max(sequence_number, place.sequence_number);
      const uint64_t target = std::min(sequence_number, place.sequence_number);
      const absl::StatusOr<bool> is_accepted = Register({source, target, kind, std::nullopt});
      if (!is_accepted.ok()) return is_accepted.status();
      if (*is_accepted) break;
    }
    return absl::OkStatus();
  }

 private:
  RelativePoseOptions RelativeOptions() const {
    RelativePoseOptions relative;
    relative.shared_gap = options_.min_loop_gap - 1;
    return relative;
  }

  absl::StatusOr<std::vector<AlikePlace>> Ranked(uint64_t sequence_number, const std::vector<uint64_t>& places) {
    const absl::StatusOr<std::shared_ptr<const PreparedScan>> scan = load_(sequence_number, stop_);
    if (!scan.ok()) return scan.status();
    const absl::StatusOr<ViewFeatures> features = PlaceFeatures(**scan, stop_);
    if (!features.ok()) return features.status();
    return RankPlaces(*features, places, load_, stop_);
  }

  // False also when a scan is not kept.
  absl::StatusOr<bool> Register(const LinkRequest& request) {
    if (source_ == nullptr || source_number_ != request.source) {
      const absl::StatusOr<std::shared_ptr<const PreparedScan>> source = load_(request.source, stop_);
      if (absl::IsNotFound(source.status())) return false;
      if (!source.ok()) return source.status();
      source_ = *source;
      source_number_ = request.source;
    }
    absl::StatusOr<TraverseLink> link = RegisterLink(*source_, request, load_, options_.registration, stop_);
    if (absl::IsNotFound(link.status())) return false;
    if (!link.ok()) return link.status();
    links_.push_back(*std::move(link));
    return links_.back().result.verdict.accepted;
  }

  const Traverse& traverse_;
  const TraverseScanLoader& load_;
  const TrackingOptions& options_;
  const Stop& stop_;
  std::vector<TraverseLink> links_;
  std::shared_ptr<const PreparedScan> source_;  // the last one used
  uint64_t source_number_ = 0;
};

// The first, the last and some scans between of each segment that has older ones: where it may touch them.
std::vector<uint64_t> ScansToRecognise(const Traverse& traverse) {
  constexpr size_t kPerSegment = 4;
  std::map<int, std::vector<uint64_t>> by_segment;
  for (const TrajectoryPose& pose : traverse.poses) by_segment[pose.segment].push_back(pose.sequence_number);
  std::vector<uint64_t> scans;
  for (auto segment = by_segment.begin(); segment != by_segment.end(); ++segment) {
    if (segment == by_segment.begin()) continue;
    const std::vector<uint64_t>& numbers = segment->second;
    const size_t count = std::min(kPerSegment, numbers.size());
    for (size_t i = 0; i < count; ++i) {
      scans.push_back(numbers[count == 1 ? 0 : i * (numbers.size() - 1) / (count - 1)]);
    }
  }
  return scans;
}

}  // namespace

absl::StatusOr<std::vector<TraverseLink>> FindLinks(const Traverse& traverse, uint64_t sequence_number,
                                                    const TraverseScanLoader& load, const TrackingOptions& options,
                                                    const Stop& stop) {
  if (sequence_number >= traverse.poses.size()) return absl::InvalidArgumentError("the traverse has no such scan");
  LinkFinder finder(traverse, load, options, stop);
  const std::vector<PairCandidate> neighbours = FindNeighbourCandidates(traverse, sequence_number, options);
  absl::Status status = finder.RegisterPairs(neighbours, LinkKind::kNeighbour);
  if (!status.ok()) return status;
  int num_tries = options.max_loop_candidates;
  status = finder.SearchOlderSegments(sequence_number, LinkKind::kNeighbour, num_tries);
  if (!status.ok()) return status;
  return finder.Take();
}

absl::StatusOr<std::vector<TraverseLink>> FindLoopClosures(const Traverse& traverse, const TraverseScanLoader& load,
                                                           const TrackingOptions& options, const Stop& stop) {
  LinkFinder finder(traverse, load, options, stop);
  const std::vector<PairCandidate> loops = FindLoopCandidates(traverse, options);
  absl::Status status = finder.RegisterPairs(loops, LinkKind::kLoopClosure);
  if (!status.ok()) return status;
  int num_tries = options.max_loop_candidates;
  for (const uint64_t sequence_number : ScansToRecognise(traverse)) {
    status = finder.SearchOlderSegments(sequence_number, LinkKind::kLoopClosure, num_tries);
    if (!status.ok()) return status;
  }
  return finder.Take();
}

}  // namespace curvereg
