// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Sets of pairs registered and their figures printed, for the tests of promised accuracy. Needs curvereg::eval.
#ifndef CURVEREG_TESTS_TESTING_EVALUATION_H_
#define CURVEREG_TESTS_TESTING_EVALUATION_H_

#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "core/base/parallel.h"
#include "core/methods/registration_names.h"
#include "core/register_scans.h"
#include "eval/metrics.h"

namespace curvereg::testing {

using Prepared = std::shared_ptr<const PreparedScan>;

// `scan` ready for any number of partners; null when it cannot be used.
inline Prepared PrepareScan(Scan scan, int num_threads) {
  absl::StatusOr<std::unique_ptr<const PreparedScan>> prepared = absl::UnknownError("not run");
  WithThreadLimit(num_threads, [&] { prepared = PreparedScan::Create(std::make_shared<Scan>(std::move(scan))); });
  return prepared.ok() ? Prepared(*std::move(prepared)) : nullptr;
}

// The answer for one pair beside its truth (none: the scans share no ground).
inline PairOutcome RegisterPair(const Prepared& source, const Prepared& target,
                                const std::optional<RigidTransform>& true_T_target_source,
                                const RegistrationOptions& options) {
  PairOutcome outcome;
  outcome.true_T_target_source = true_T_target_source;
  const absl::StatusOr<RegistrationResult> result = RegisterPreparedScans(*source, *target, options);
  if (!result.ok()) {
    outcome.error = result.status().ToString();
    return outcome;
  }
  outcome.result = *result;
  outcome.seconds = result->total_seconds;
  return outcome;
}

inline void PrintHeader() {
  std::printf("%-34s %5s %5s %8s %5s %8s %7s %8s %8s %8s %8s %7s\n", "set", "pairs", "ok", "accepted", "wrong",
              "rejected", "no_pose", "rmse_mm", "rmse_mrd", "ok_mm", "ok_mrad", "p50_ms");
}

// The figures of `curvereg evaluate`; the time is that of a pair of scans prepared before.
inline void PrintSummary(const std::string& name, const MethodSummary& s) {
  std::printf("%-34s %5d %5d %8d %5d %8d %7d %8.2f %8.3f %8.2f %8.3f %7.1f\n", name.c_str(), s.pairs + s.negatives,
              s.ok, s.accepted, s.accepted_wrong, s.rejected_right, s.no_pose, 1e3 * s.rmse_translation_m,
              1e3 * s.rmse_rotation_rad, 1e3 * s.rmse_ok_translation_m, 1e3 * s.rmse_ok_rotation_rad, 1e3 * s.median_s);
  std::fflush(stdout);
}

inline bool IsAcceptedWrong(const PairOutcome& outcome) { return outcome.result.verdict.accepted && !IsOk(outcome); }

// One line: names, verdict, errors and the evidence behind them.
inline std::string Describe(const PairOutcome& outcome) {
  const RegistrationResult& result = outcome.result;
  const Evidence& evidence = result.evidence;
  const TransformDifference error = PoseError(outcome);
  std::string verdict = result.verdict.accepted ? "accepted" : "rejected";
  for (const Reason reason : result.verdict.reasons) verdict.append(" ").append(ReasonName(reason));
  const auto value = [](const std::optional<double>& measure) { return measure.value_or(-1.0); };
  return absl::StrFormat(
      "%s -> %s %s: off by %.3f m, %.4f rad; overlap %.2f %.2f, free space %.3f, correlation %.2f, inliers %.2f, "
      "runner-up %.2f, attempts %d %s",
      outcome.source, outcome.target, verdict, error.translation_m, error.rotation_rad, value(evidence.overlap_source),
      value(evidence.overlap_target), value(evidence.free_space_agreement), value(evidence.image_correlation),
      value(evidence.inlier_fraction), value(evidence.runner_up_ratio), evidence.num_attempts, outcome.error);
}

// Names every pair that is not both ok and accepted, and every negative pair that is accepted.
inline void PrintTroubles(const std::vector<PairOutcome>& outcomes) {
  for (const PairOutcome& outcome : outcomes) {
    const bool accepted = outcome.result.verdict.accepted;
    const bool is_fine = outcome.true_T_target_source.has_value() ? IsOk(outcome) && accepted : !accepted;
    if (!is_fine || !outcome.error.empty()) std::printf("    %s\n", Describe(outcome).c_str());
  }
}

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_TESTING_EVALUATION_H_
