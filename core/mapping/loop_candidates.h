// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Which pairs of a traverse's scans are worth a registration, judged by their positions alone.
#ifndef CURVEREG_CORE_MAPPING_LOOP_CANDIDATES_H_
#define CURVEREG_CORE_MAPPING_LOOP_CANDIDATES_H_

#include <cstdint>
#include <functional>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/mapping/tracking_options.h"
#include "core/mapping/trajectory.h"

namespace curvereg {

struct PairCandidate {
  uint64_t source = 0;  // sequence numbers; target < source
  uint64_t target = 0;
  double distance_m = 0.0;  // of the two positions
};

// Tries a pair. False: it could not be tried, because one of its scans is not kept; it then counts for nothing. An
// error ends the search.
using TryPair = std::function<absl::StatusOr<bool>(const PairCandidate& pair)>;

// The scans nearest to this one, of its segment, within max_neighbour_distance_m, that have no link with it yet:
// nearest first, until `num_neighbours` were tried or kMaxNotKept could not be. O(poses log poses + links).
absl::Status TryNeighbours(const Traverse& traverse, uint64_t sequence_number, const TrackingOptions& options,
                           const TryPair& try_pair);

// Pairs of one segment, min_loop_gap (at least 1) or more apart in sequence, whose distance is below loop_distance_m
// plus three standard deviations of it, until max_loop_candidates were tried: nearest first, but spread along the path:
// pairs that repeat one that was tried, or an accepted link, come last. Pairs that have a link are left out, and so are
// all but the hundred nearest earlier scans of a scan. O(poses^2 + links) time, O(poses + links) memory.
absl::Status TryLoops(const Traverse& traverse, const TrackingOptions& options, const TryPair& try_pair);

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_LOOP_CANDIDATES_H_
