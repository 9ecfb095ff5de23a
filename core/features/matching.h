// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Nearest neighbours in descriptor space.
#ifndef CURVEREG_CORE_FEATURES_MATCHING_H_
#define CURVEREG_CORE_FEATURES_MATCHING_H_

#include <vector>

#include "core/features/descriptors.h"

namespace curvereg {

// Indices into the features of the two scans.
struct Match {
  int source = 0;
  int target = 0;
  float distance = 0.0F;  // Euclidean, of unit descriptors: [0, 2]
};

// Pairs that are each other's nearest neighbour among the features of the same level and the same sign of response
// (a hill never matches a hollow). Exact search. Ordered by source index. Empty input gives no matches.
std::vector<Match> MatchMutualNearest(const Features& source, const Features& target);

}  // namespace curvereg

#endif  // CURVEREG_CORE_FEATURES_MATCHING_H_
