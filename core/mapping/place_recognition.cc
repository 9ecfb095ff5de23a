// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/place_recognition.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/base/stop_status.h"
#include "core/mapping/link_registration.h"
#include "core/pose/pose_hypotheses.h"

namespace curvereg {

absl::StatusOr<ViewFeatures> PlaceFeatures(const PreparedScan& scan, const Stop& stop) {
  const absl::StatusOr<const ViewFeatures*> view = scan.View(BirdsEyeView::kElevation, 0, stop);
  if (!view.ok()) return view.status();
  ViewFeatures place;
  place.R_level_sensor = (*view)->R_level_sensor;
  place.features = (*view)->features;
  place.planar = (*view)->planar;
  place.heights_m = (*view)->heights_m;
  return place;
}

int PlaceLikeness(const ViewFeatures& a, const ViewFeatures& b) {
  ConsensusOptions options;
  options.max_hypotheses = 1;
  const HypothesesFromViews found = FindPoseHypotheses(a, b, options);
  return found.hypotheses.empty() ? 0 : found.hypotheses.front().num_inliers;
}

absl::StatusOr<std::vector<AlikePlace>> RankPlaces(const ViewFeatures& place, const PlacesToCompare& to_compare,
                                                   const TraverseScanLoader& load, const Stop& stop) {
  std::vector<AlikePlace> places;
  const auto most = static_cast<size_t>(std::max(0, to_compare.most));
  int num_not_kept = 0;
  for (const uint64_t number : to_compare.sequence_numbers) {
    if (places.size() >= most || num_not_kept >= kMaxNotKept) break;
    if (absl::Status status = StopStatus(stop, "work on the traverse"); !status.ok()) return status;
    const absl::StatusOr<std::shared_ptr<const PreparedScan>> scan = load(number, stop);
    if (absl::IsNotFound(scan.status())) {
      ++num_not_kept;
      continue;
    }
    if (!scan.ok()) return scan.status();
    const absl::StatusOr<const ViewFeatures*> view = (*scan)->View(BirdsEyeView::kElevation, 0, stop);
    if (!view.ok()) return view.status();
    places.push_back({number, PlaceLikeness(place, **view)});
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const AlikePlace& a, const AlikePlace& b) { return a.likeness > b.likeness; });
  return places;
}

std::vector<uint64_t> PlacesOfOlderSegments(const Traverse& traverse, uint64_t sequence_number, int most) {
  const int segment = traverse.poses[sequence_number].segment;
  std::vector<uint64_t> older;
  std::map<int, uint64_t> last_of_segment;
  for (const TrajectoryPose& pose : traverse.poses) {
    if (pose.segment >= segment) continue;
    older.push_back(pose.sequence_number);
    last_of_segment[pose.segment] = pose.sequence_number;
  }
  const auto limit = static_cast<size_t>(std::max(1, most));
  std::vector<uint64_t> places;
  std::set<uint64_t> chosen;
  const auto choose = [&](uint64_t number) {
    if (chosen.insert(number).second) places.push_back(number);
  };
  for (auto last = last_of_segment.rbegin(); last != last_of_segment.rend() && 2 * places.size() < limit; ++last) {
    choose(last->second);
  }
  const size_t num_others = std::max<size_t>(1, limit - places.size());
  const size_t stride = std::max<size_t>(1, (older.size() + num_others - 1) / num_others);
  for (size_t offset = 0; offset < stride; ++offset) {
    for (size_t i = (sequence_number + offset) % stride; i < older.size(); i += stride) choose(older[i]);
  }
  return places;
}

}  // namespace curvereg
