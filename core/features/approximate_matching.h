// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Approximate nearest neighbours in descriptor space with FLANN, as the paper matches. Of FLANN's indices the single
// kd-tree, which draws no random numbers: same descriptors, same matches, whatever runs beside
// (docs/adr/2026-11-22-flann-for-the-paper-method.md).
#ifndef CURVEREG_CORE_FEATURES_APPROXIMATE_MATCHING_H_
#define CURVEREG_CORE_FEATURES_APPROXIMATE_MATCHING_H_

#include <vector>

#include "absl/status/statusor.h"
#include "core/base/stop.h"
#include "core/features/descriptors.h"
#include "core/features/matching.h"

namespace curvereg {

struct ApproximateMatchingOptions {
  // The neighbour found is at most sqrt(1 + epsilon) times as far as the nearest; in [0, 1e6], 0 is exact. Default: a
  // factor of two at worst; on scans of terrain and of a dome it changed none of 439 matches and took 2/3 of the time.
  double epsilon = 3.0;
};

// Pairs that are each other's (approximate) nearest neighbour among all features, of whatever level and sign: the paper
// draws no line between them. Ordered by source index. Empty input gives no matches. Blocks of queries run in parallel.
// Precondition: descriptors are finite. CANCELLED, DEADLINE_EXCEEDED: `stop` was requested; asked every 16 queries.
absl::StatusOr<std::vector<Match>> MatchApproximateMutualNearest(const Features& source, const Features& target,
                                                                 const ApproximateMatchingOptions& options,
                                                                 const Stop& stop);

}  // namespace curvereg

#endif  // CURVEREG_CORE_FEATURES_APPROXIMATE_MATCHING_H_
