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
#include "core/mapping/tracking.h"
#include "core/view_features.h"

namespace curvereg {

// The features of a scan's elevation view without its images: some hundred kilobytes.
absl::StatusOr<ViewFeatures> PlaceFeatures(const PreparedScan& scan, const Stop& stop = {});

// Matches that agree on one motion; 0 when there is none. About a millisecond.
int PlaceLikeness(const ViewFeatures& a, const ViewFeatures& b);

struct AlikePlace {
  uint64_t sequence_number = 0;
  int likeness = 0;
};

// The scans of `sequence_numbers` by likeness, most alike first; those that are not kept (`load` says NOT_FOUND) are
// left out. Holds one of them at a time.
absl::StatusOr<std::vector<AlikePlace>> RankPlaces(const ViewFeatures& place,
                                                   std::span<const uint64_t> sequence_numbers,
                                                   const TraverseScanLoader& load, const Stop& stop = {});

// At most `most` of the poses of segments older than this one's that are worth a look: the last of each older segment
// first, where the path broke off, then others spread evenly over all older segments; another scan of the same segment
// sees other ones.
std::vector<uint64_t> PlacesOfOlderSegments(const Traverse& traverse, uint64_t sequence_number, int most);

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_PLACE_RECOGNITION_H_
