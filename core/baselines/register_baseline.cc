// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/baselines/register_baseline.h"

#include <string>

#include "core/methods/registration_names.h"

#ifdef CURVEREG_HAS_BASELINES
#include "core/baselines/fpfh_sac_ia.h"
#include "core/baselines/harris3d_fpfh.h"
#include "core/methods/stage_timer.h"
#endif

namespace curvereg {

#ifdef CURVEREG_HAS_BASELINES

bool HasBaselines() { return true; }

absl::StatusOr<RegistrationResult> RegisterBaseline(const Scan& source, const Scan& target,
                                                    const RegistrationOptions& options, const Stop& stop) {
  BaselineOptions baseline_options;
  baseline_options.seed = options.seed;
  baseline_options.stop = stop;
  StageTimer timer;
  const absl::StatusOr<BaselineResult> baseline = options.method == Method::kFpfhSacIa
                                                      ? RegisterFpfhSacIa(source, target, baseline_options)
                                                      : RegisterHarris3dFpfh(source, target, baseline_options);
  if (!baseline.ok()) return baseline.status();
  RegistrationResult result;
  result.T_target_source = baseline->T_target_source;
  result.verdict.reasons.clear();
  if (baseline->failure.has_value()) {
    result.verdict.reasons.push_back(*baseline->failure);
  } else if (!baseline->T_target_source.has_value() || !baseline->converged) {
    result.verdict.reasons.push_back(Reason::kNoConsensus);
  }
  result.verdict.accepted = result.verdict.reasons.empty();
  result.evidence.num_source_keypoints = baseline->num_source_keypoints;
  result.evidence.num_target_keypoints = baseline->num_target_keypoints;
  result.evidence.num_matches = baseline->num_matches;
  result.evidence.num_inliers = baseline->num_inliers;
  result.evidence.num_hypotheses = 1;
  result.evidence.num_attempts = 1;
  result.evidence.residual_rmse_m = baseline->residual_rmse_m;
  timer.Lap("method");
  result.stage_times = timer.Take();
  return result;
}

#else

bool HasBaselines() { return false; }

absl::StatusOr<RegistrationResult> RegisterBaseline(const Scan&, const Scan&, const RegistrationOptions& options,
                                                    const Stop&) {
  return absl::UnimplementedError(std::string("this build leaves out the method ") +
                                  std::string(MethodName(options.method)) + " (needs PCL)");
}

#endif

}  // namespace curvereg
