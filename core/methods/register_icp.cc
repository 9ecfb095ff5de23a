// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/methods/register_icp.h"

#include <algorithm>

#include "core/methods/stage_timer.h"
#include "core/methods/verdict.h"
#include "core/pose/refinement.h"

namespace curvereg {

absl::StatusOr<RegistrationResult> RegisterIcp(const PreparedScan& source, const PreparedScan& target,
                                               const RegistrationOptions& options, const Stop& stop) {
  RegistrationResult result;
  StageTimer timer;
  RigidTransform T_target_source = RigidTransform::Identity();
  if (options.prior.has_value()) T_target_source = options.prior->T_target_source;
  PoseEvidence evidence;
  const size_t coarsest = source.voxel_maps().size() - 1;
  for (size_t level = coarsest + 1; level-- > 0;) {
    evidence.fit = RefineOnLevels(source.voxel_maps(), target.voxel_maps(), {level, coarsest}, T_target_source,
                                  RefinementOptions{}, stop);
    T_target_source = evidence.fit.T_target_source;
  }
  timer.Lap("refinement");
  evidence.check = CheckPose(source, target, T_target_source);
  for (const BirdsEyeView kind : {BirdsEyeView::kElevation, BirdsEyeView::kOccupancy}) {
    const auto source_view = source.View(kind, 0, stop);
    const auto target_view = target.View(kind, 0, stop);
    if (stop.Requested()) break;
    if (!source_view.ok()) return source_view.status();
    if (!target_view.ok()) return target_view.status();
    const double ncc = CorrelateViews(**source_view, **target_view, T_target_source).ncc;
    evidence.image_correlation = std::max(evidence.image_correlation, ncc);
  }
  if (stop.Cancelled()) return absl::CancelledError("registration was cancelled");
  FillResult(T_target_source, evidence, result);
  result.evidence.num_hypotheses = 1;
  result.evidence.num_attempts = 1;
  if (stop.PastDeadline()) {
    result.verdict.accepted = false;
    result.verdict.reasons.push_back(Reason::kDeadline);
  }
  timer.Lap("verification");
  result.stage_times = timer.Take();
  return result;
}

}  // namespace curvereg
