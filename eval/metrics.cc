// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/metrics.h"

#include "eval/distribution.h"

namespace curvereg {
namespace {

// Counts that pairs and negatives share.
void CountVerdict(const PairOutcome& outcome, bool ok, MethodSummary& summary) {
  const bool accepted = outcome.result.verdict.accepted;
  summary.ok += ok;
  summary.accepted += accepted;
  summary.accepted_wrong += accepted && !ok;
  summary.rejected_right += ok && !accepted;
  summary.failed_calls += !outcome.error.empty();
}

}  // namespace

TransformDifference PoseError(const PairOutcome& outcome) {
  if (!outcome.result.T_target_source || !outcome.true_T_target_source) return {kUnknown, kUnknown};
  return Difference(*outcome.true_T_target_source, *outcome.result.T_target_source);
}

bool IsOk(const PairOutcome& outcome, const SuccessBounds& bounds) {
  const TransformDifference error = PoseError(outcome);
  return error.translation_m < bounds.translation_m && error.rotation_rad < bounds.rotation_rad;  // false for NaN
}

MethodSummary Summarise(std::span<const PairOutcome> outcomes, const SuccessBounds& bounds) {
  MethodSummary summary;
  std::vector<double> translations, rotations, ok_translations, ok_rotations, seconds;
  for (const PairOutcome& outcome : outcomes) {
    const bool ok = IsOk(outcome, bounds);
    CountVerdict(outcome, ok, summary);
    if (!outcome.true_T_target_source) {
      ++summary.negatives;
      summary.negatives_accepted += outcome.result.verdict.accepted;
      continue;
    }
    ++summary.pairs;
    summary.no_pose += !outcome.result.T_target_source.has_value();
    const TransformDifference error = PoseError(outcome);
    translations.push_back(error.translation_m);
    rotations.push_back(error.rotation_rad);
    seconds.push_back(outcome.seconds);
    if (!ok) continue;
    ok_translations.push_back(error.translation_m);
    ok_rotations.push_back(error.rotation_rad);
  }
  summary.rmse_translation_m = RootMeanSquare(translations);
  summary.rmse_rotation_rad = RootMeanSquare(rotations);
  summary.median_translation_m = Quantile(translations, 0.5);
  summary.median_rotation_rad = Quantile(rotations, 0.5);
  summary.rmse_ok_translation_m = RootMeanSquare(ok_translations);
  summary.rmse_ok_rotation_rad = RootMeanSquare(ok_rotations);
  summary.median_ok_translation_m = Quantile(ok_translations, 0.5);
  summary.median_ok_rotation_rad = Quantile(ok_rotations, 0.5);
  summary.median_s = Quantile(seconds, 0.5);
  summary.p95_s = Quantile(seconds, 0.95);
  return summary;
}

}  // namespace curvereg
