// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Where the position is unknown: which scans show ground that looks like this one's. The features of two elevation
// views are matched, and the number of matches that agree on one motion says how alike the places are.
#ifndef CURVEREG_CORE_MAPPING_PLACE_RECOGNITION_H_
#define CURVEREG_CORE_MAPPING_PLACE_RECOGNITION_H_

#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/features/view_features.h"
#include "core/mapping/tracking_options.h"
#include "core/mapping/trajectory.h"

namespace curvereg {

// The features of a scan's elevation view without its images: some hundred kilobytes.
absl::StatusOr<ViewFeatures> PlaceFeatures(const PreparedScan& scan, const Stop& stop = {});

// Matches that agree on one motion; 0 when there is none. About a millisecond.
int PlaceLikeness(const ViewFeatures& a, const ViewFeatures& b);

struct AlikePlace {
  uint64_t sequence_number = 0;
  int likeness = 0;
};

// Scans to compare, those worth most first; those that are not kept (`load` says NOT_FOUND) are passed over.
struct PlacesToCompare {
  std::span<const uint64_t> sequence_numbers;
  int most = 0;  // compared; kMaxNotKept are passed over at most
};

// The places that were compared by likeness, most alike first. Holds one of them at a time.
absl::StatusOr<std::vector<AlikePlace>> RankPlaces(const ViewFeatures& place, const PlacesToCompare& places,
                                                   const TraverseScanLoader& load, const Stop& stop = {});

// The poses of segments older than this one's, in the order in which they are worth a look: the last of each older
// segment, where the path broke off, newest segment first, up to half of `most`; then others spread evenly over all
// older segments, so that the first `most` reach all of them, and the rest. Another scan of the same segment sees other
// ones first.
std::vector<uint64_t> PlacesOfOlderSegments(const Traverse& traverse, uint64_t sequence_number, int most);

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_PLACE_RECOGNITION_H_
