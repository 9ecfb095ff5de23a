// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Links of a traverse beyond tracking: with the scans around, between segments, and where the path comes back.
#ifndef CURVEREG_CORE_MAPPING_FIND_LINKS_H_
#define CURVEREG_CORE_MAPPING_FIND_LINKS_H_

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/stop.h"
#include "core/mapping/tracking_options.h"
#include "core/mapping/trajectory.h"

namespace curvereg {

// Further links of a tracked scan: with the nearest kept scans of its segment, and, as long as there are older
// segments, for its segment's first scans and some of the later ones, with places of the older segments that look alike
// (features of elevation views), until one is accepted. Only pairs that have no link yet. Scans that are not kept count
// for nothing. INVALID_ARGUMENT: no such scan; other errors as TrackScan.
absl::StatusOr<std::vector<TraverseLink>> FindLinks(const Traverse& traverse, uint64_t sequence_number,
                                                    const TraverseScanLoader& load, const TrackingOptions& options,
                                                    const Stop& stop = {});

// Links over the whole traverse: between scans of a segment far apart in sequence but near in place, and, by look, from
// each segment to older ones: with its first and last scan and two between, those of long segments first. Where there
// are so many segments that max_places_in_all does not suffice, each search compares fewer places, then short segments
// go without. Errors as TrackScan.
absl::StatusOr<std::vector<TraverseLink>> FindLoopClosures(const Traverse& traverse, const TraverseScanLoader& load,
                                                           const TrackingOptions& options, const Stop& stop = {});

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_FIND_LINKS_H_
