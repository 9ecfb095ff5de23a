// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Which pairs of a traverse's scans are worth a registration, judged by their positions alone.
#ifndef CURVEREG_CORE_MAPPING_LOOP_CANDIDATES_H_
#define CURVEREG_CORE_MAPPING_LOOP_CANDIDATES_H_

#include <cstdint>
#include <vector>

#include "core/mapping/tracking.h"

namespace curvereg {

struct PairCandidate {
  uint64_t source = 0;  // sequence numbers; target < source
  uint64_t target = 0;
  double distance_m = 0.0;  // of the two positions
};

// The `num_neighbours` scans nearest to this one, of its segment, within max_neighbour_distance_m, that have no link
// with it yet: nearest first. O(poses + links).
std::vector<PairCandidate> FindNeighbourCandidates(const Traverse& traverse, uint64_t sequence_number,
                                                   const TrackingOptions& options);

// Pairs of one segment, min_loop_gap or more apart in sequence, whose distance is below loop_distance_m plus three
// standard deviations of it: at most max_loop_candidates, nearest first, but spread along the path: pairs that repeat a
// better one, or an accepted link, come last. Pairs that have a link are left out. O(poses^2 + links).
std::vector<PairCandidate> FindLoopCandidates(const Traverse& traverse, const TrackingOptions& options);

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_LOOP_CANDIDATES_H_
