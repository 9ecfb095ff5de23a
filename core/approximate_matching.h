// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Approximate nearest neighbours in descriptor space with FLANN, as the paper matches. Of FLANN's indices the single
// kd-tree, which draws no random numbers: same descriptors, same matches, whatever runs beside
// (docs/adr/2026-11-22-flann-for-the-paper-method.md).
#ifndef CURVEREG_CORE_APPROXIMATE_MATCHING_H_
#define CURVEREG_CORE_APPROXIMATE_MATCHING_H_

#include <vector>

#include "core/descriptors.h"
#include "core/matching.h"

namespace curvereg {

struct ApproximateMatchingOptions {
  // A neighbour is taken when no other can be nearer than its distance / sqrt(1 + epsilon); >= 0, 0 is exact. In
  // practice the nearest is found nearly always, because the tree's bounds are loose in 128 dimensions.
  double epsilon = 0.5;
};

// Pairs that are each other's (approximate) nearest neighbour among all features, of whatever level and sign: the paper
// draws no line between them. Ordered by source index. Empty input gives no matches. The two directions run in
// parallel. Precondition: descriptors are finite.
std::vector<Match> MatchApproximateMutualNearest(const Features& source, const Features& target,
                                                 const ApproximateMatchingOptions& options = {});

}  // namespace curvereg

#endif  // CURVEREG_CORE_APPROXIMATE_MATCHING_H_
