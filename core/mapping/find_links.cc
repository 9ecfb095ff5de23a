// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/find_links.h"

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "core/mapping/link_registration.h"
#include "core/mapping/loop_candidates.h"
#include "core/mapping/place_recognition.h"
#include "core/mapping/pose_uncertainty.h"

namespace curvereg {
namespace {

class LinkFinder {
 public:
  LinkFinder(const Traverse& traverse, const TraverseScanLoader& load, const TrackingOptions& options, const Stop& stop)
      : traverse_(traverse), load_(load), options_(options), stop_(stop) {}

  std::vector<TraverseLink> Take() { return std::move(links_); }

  // Registers pairs whose positions are known.
  TryPair TryWithPrior(LinkKind kind) {
    return [this, kind](const PairCandidate& pair) -> absl::StatusOr<bool> {
      const Prior relative = RelativePose(traverse_.poses[pair.target], traverse_.poses[pair.source],
                                          {.shared_gap = std::max(1, options_.min_loop_gap) - 1});
      const absl::StatusOr<Outcome> outcome = Register({pair.source, pair.target, kind, relative});
      if (!outcome.ok()) return outcome.status();
      return *outcome != Outcome::kNotKept;
    };
  }

  struct PlaceSearch {
    uint64_t sequence_number = 0;
    LinkKind kind = LinkKind::kNeighbour;
    int max_places = 0;  // compared
  };
  // Tries places of older segments that look like the scan's, until one is recognised. Uses up `num_tries`.
  absl::Status SearchOlderSegments(const PlaceSearch& search, int& num_tries) {
    const uint64_t sequence_number = search.sequence_number;
    if (num_tries <= 0) return absl::OkStatus();
    const std::vector<uint64_t> places = PlacesOfOlderSegments(traverse_, sequence_number, search.max_places);
    if (places.empty()) return absl::OkStatus();
    const absl::StatusOr<std::vector<AlikePlace>> ranked = Ranked(sequence_number, {places, search.max_places});
    if (absl::IsNotFound(ranked.status())) return absl::OkStatus();
    if (!ranked.ok()) return ranked.status();
    const std::set<uint64_t> partners = LinkedPartners(traverse_, sequence_number);
    for (const AlikePlace& place : *ranked) {
      if (num_tries <= 0 || place.likeness == 0) break;
      if (partners.contains(place.sequence_number)) continue;
      const uint64_t source = std::max(sequence_number, place.sequence_number);
      const uint64_t target = std::min(sequence_number, place.sequence_number);
      const absl::StatusOr<Outcome> outcome = Register({source, target, search.kind, std::nullopt});
      if (!outcome.ok()) return outcome.status();
      if (*outcome != Outcome::kNotKept) --num_tries;
      if (*outcome == Outcome::kAccepted) break;
    }
    return absl::OkStatus();
  }

 private:
  enum class Outcome { kNotKept, kRejected, kAccepted };

  // Asks once for each scan that is not kept: it may be in many pairs.
  absl::StatusOr<std::shared_ptr<const PreparedScan>> Load(uint64_t sequence_number) {
    if (not_kept_.contains(sequence_number)) return absl::NotFoundError("not kept");
    absl::StatusOr<std::shared_ptr<const PreparedScan>> scan = load_(sequence_number, stop_);
    if (absl::IsNotFound(scan.status())) not_kept_.insert(sequence_number);
    return scan;
  }
  TraverseScanLoader Loader() {
    return [this](uint64_t sequence_number, const Stop& /*stop*/) { return Load(sequence_number); };
  }

  absl::StatusOr<std::vector<AlikePlace>> Ranked(uint64_t sequence_number, const PlacesToCompare& places) {
    const absl::StatusOr<std::shared_ptr<const PreparedScan>> scan = Load(sequence_number);
    if (!scan.ok()) return scan.status();
    const absl::StatusOr<ViewFeatures> features = PlaceFeatures(**scan, stop_);
    if (!features.ok()) return features.status();
    return RankPlaces(*features, places, Loader(), stop_);
  }

  absl::StatusOr<Outcome> Register(const LinkRequest& request) {
    if (not_kept_.contains(request.target)) return Outcome::kNotKept;  // before the source is loaded
    if (source_ == nullptr || source_number_ != request.source) {
      const absl::StatusOr<std::shared_ptr<const PreparedScan>> source = Load(request.source);
      if (absl::IsNotFound(source.status())) return Outcome::kNotKept;
      if (!source.ok()) return source.status();
      source_ = *source;
      source_number_ = request.source;
    }
    absl::StatusOr<TraverseLink> link = RegisterLink(*source_, request, Loader(), options_.registration, stop_);
    if (absl::IsNotFound(link.status())) return Outcome::kNotKept;
    if (!link.ok()) return link.status();
    links_.push_back(*std::move(link));
    return links_.back().result.verdict.accepted ? Outcome::kAccepted : Outcome::kRejected;
  }

  const Traverse& traverse_;
  const TraverseScanLoader& load_;
  const TrackingOptions& options_;
  const Stop& stop_;
  std::vector<TraverseLink> links_;
  std::set<uint64_t> not_kept_;
  std::shared_ptr<const PreparedScan> source_;  // the last one used
  uint64_t source_number_ = 0;
};

// Whether FindLinks looks for the scan's place in older segments.
bool IsToBeRecognised(const Traverse& traverse, uint64_t sequence_number, const TrackingOptions& options) {
  const int segment = traverse.poses[sequence_number].segment;
  const auto rank =
      std::count_if(traverse.poses.begin(), traverse.poses.begin() + static_cast<int64_t>(sequence_number),
                    [&](const TrajectoryPose& pose) { return pose.segment == segment; });
  const int64_t after_first = rank - options.num_scans_to_recognise;
  return after_first < 0 || after_first % std::max(1, options.recognition_interval) == 0;
}

// The first, the last and two scans between of each segment that has older ones: where it may touch them. First those
// of the segments with most scans, and as many in all as max_places_in_all has places for.
std::vector<uint64_t> ScansToRecognise(const Traverse& traverse, const TrackingOptions& options) {
  constexpr int kFewestPlaces = 8;  // that a search compares
  std::map<int, std::vector<uint64_t>> by_segment;
  for (const TrajectoryPose& pose : traverse.poses) by_segment[pose.segment].push_back(pose.sequence_number);
  std::vector<std::vector<uint64_t>> segments;
  for (auto& [segment, numbers] : by_segment) segments.push_back(std::move(numbers));
  if (!segments.empty()) segments.erase(segments.begin());
  std::stable_sort(segments.begin(), segments.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  const auto most = static_cast<size_t>(std::max(0, options.max_places_in_all / kFewestPlaces));
  std::vector<uint64_t> scans;
  std::set<uint64_t> chosen;
  for (const size_t third : {0U, 3U, 1U, 2U}) {
    for (const std::vector<uint64_t>& numbers : segments) {
      const uint64_t number = numbers[third * (numbers.size() - 1) / 3];
      if (scans.size() < most && chosen.insert(number).second) scans.push_back(number);
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
  absl::Status status = TryNeighbours(traverse, sequence_number, options, finder.TryWithPrior(LinkKind::kNeighbour));
  if (!status.ok()) return status;
  int num_tries = options.max_loop_candidates;
  if (IsToBeRecognised(traverse, sequence_number, options)) {
    status =
        finder.SearchOlderSegments({sequence_number, LinkKind::kNeighbour, options.max_places_compared}, num_tries);
    if (!status.ok()) return status;
  }
  return finder.Take();
}

absl::StatusOr<std::vector<TraverseLink>> FindLoopClosures(const Traverse& traverse, const TraverseScanLoader& load,
                                                           const TrackingOptions& options, const Stop& stop) {
  LinkFinder finder(traverse, load, options, stop);
  absl::Status status = TryLoops(traverse, options, finder.TryWithPrior(LinkKind::kLoopClosure));
  if (!status.ok()) return status;
  int num_tries = options.max_loop_candidates;
  const std::vector<uint64_t> scans = ScansToRecognise(traverse, options);
  const int places_each = options.max_places_in_all / std::max(1, static_cast<int>(scans.size()));
  for (const uint64_t sequence_number : scans) {
    const int max_places = std::min(places_each, options.max_places_compared);
    status = finder.SearchOlderSegments({sequence_number, LinkKind::kLoopClosure, max_places}, num_tries);
    if (!status.ok()) return status;
  }
  return finder.Take();
}

}  // namespace curvereg
