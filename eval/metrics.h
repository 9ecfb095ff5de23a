// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Error metrics: what a method answered for each pair against the truth, and the figures of a method over all pairs.
#ifndef CURVEREG_EVAL_METRICS_H_
#define CURVEREG_EVAL_METRICS_H_

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/rigid_transform.h"
#include "core/methods/registration_result.h"

namespace curvereg {

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// What one method answered for one pair.
struct PairOutcome {
  std::string source;
  std::string target;
  std::optional<RigidTransform> true_T_target_source;  // nullopt: negatives, two scans that share no ground
  double overlap = -1.0;                               // as in ScanPair
  RegistrationResult result;                           // born rejected; stays so when the call failed
  std::string error;                                   // why the call could not be done; empty when it was
  double seconds = kUnknown;                           // as the result tells: two scans in memory to answer
};

// A pose counts as right below both: the paper's bounds are of this size, and refinement converges from there.
struct SuccessBounds {
  double translation_m = 0.5;
  double rotation_rad = 0.1;
};

// |t - t_true| [m] and the angle of R_true^T R [rad]; NaN without a pose or without truth.
TransformDifference PoseError(const PairOutcome& outcome);

// True when there is a pose and its error is below both bounds. Negative pairs never are.
bool IsOk(const PairOutcome& outcome, const SuccessBounds& bounds = {});

// The figures of one method. Every pair with truth counts in `pairs`, also those whose call failed.
// RMSE and medians over all pairs leave out the pairs without a pose, as these have no error: `no_pose` counts them and
// they are never ok. Figures over no pair at all are NaN. Seconds are those of pairs with truth.
struct MethodSummary {
  int pairs = 0;      // with truth
  int negatives = 0;  // pairs that share no ground
  int ok = 0;
  int accepted = 0;        // of pairs and negative pairs
  int accepted_wrong = 0;  // accepted but not ok; an accepted pair of negatives is always wrong
  int rejected_right = 0;  // ok but rejected
  int no_pose = 0;         // of pairs
  int failed_calls = 0;    // of pairs and negative pairs: no answer but an error
  int negatives_accepted = 0;
  double rmse_translation_m = kUnknown;
  double rmse_rotation_rad = kUnknown;
  double median_translation_m = kUnknown;
  double median_rotation_rad = kUnknown;
  double rmse_ok_translation_m = kUnknown;
  double rmse_ok_rotation_rad = kUnknown;
  double median_ok_translation_m = kUnknown;
  double median_ok_rotation_rad = kUnknown;
  double median_s = kUnknown;
  double p95_s = kUnknown;
};

MethodSummary Summarise(std::span<const PairOutcome> outcomes, const SuccessBounds& bounds = {});

}  // namespace curvereg

#endif  // CURVEREG_EVAL_METRICS_H_
