// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Random sample consensus over pairs of 3-D points, most of which are wrong: the rigid transform of three random pairs
// that most of all pairs agree with [M. A. Fischler, R. C. Bolles, CACM 24(6), 1981].
// Deterministic: same pairs, options and seed, same bytes; runs on one thread.
#ifndef CURVEREG_CORE_POSE_RANSAC_H_
#define CURVEREG_CORE_POSE_RANSAC_H_

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/rigid_transform.h"
#include "core/base/stop.h"
#include "core/pose/rigid_fit.h"

namespace curvereg {

struct RansacOptions {
  double inlier_threshold_m = 0.5;  // a pair agrees with a transform that leaves at most this distance, > 0 [m]
  int max_iterations = 100'000;     // samples drawn at most, > 0; finds 4.1 % of right pairs with 99.9 % probability
  // Ends as soon as a consensus as large as the best would have been found with this probability, in (0, 1).
  double confidence = 0.999;
  uint64_t seed = 1;
};

// OK, or INVALID_ARGUMENT that names the option out of its range.
absl::Status Validate(const RansacOptions& options);

struct RansacResult {
  std::optional<RigidTransform> T_target_source;  // of the sample itself, not refitted; none: no sample had a consensus
  std::vector<int> inliers;                       // indices of the pairs that agree with it, ascending; at least 3
  int num_iterations = 0;                         // samples drawn
  bool is_complete = false;                       // false: stopped by the deadline before one of the two limits above
};

// Fewer than three pairs, or only pairs that no rigid transform can join, give no pose. Of transforms with equally many
// inliers the first is kept. The stop is asked every 64 samples; past its deadline the best so far is returned.
// INVALID_ARGUMENT: an option out of range, a coordinate that is not finite. CANCELLED: the stop's cancellation.
// Cost: a sample is dropped in 50 ns when its edges differ in length by more than two thresholds, because no transform
// then agrees with all three of its pairs; others cost one fit and one pass over the pairs.
absl::StatusOr<RansacResult> FindRigidConsensus(std::span<const PointPair> pairs, const RansacOptions& options,
                                                const Stop& stop);

// Natural logarithm of the number of consensus sets of at least `num_inliers` pairs that chance alone would be expected
// to bring forth, when a wrong pair agrees with a given transform with probability `chance` in (0, 1]:
// (n - 3) C(n, k) C(k, 3) chance^(k - 3) [L. Moisan, B. Stival, "A probabilistic criterion to detect rigid point
// matches between two images", IJCV 57(3), 2004, eq. (9)]. Far below 0 means that chance does not explain the
// consensus. Precondition: 0 <= num_inliers <= num_pairs. Infinite for fewer than four inliers: the sample explains
// three itself.
double LogFalseAlarms(int num_pairs, int num_inliers, double chance);

}  // namespace curvereg

#endif  // CURVEREG_CORE_POSE_RANSAC_H_
