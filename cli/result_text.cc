// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/result_text.h"

#include <cmath>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/methods/registration_names.h"

namespace curvereg::cli {
namespace {

constexpr double kDegreesPerRadian = 180.0 / M_PI;

std::string VerdictText(const Verdict& verdict) {
  if (verdict.accepted) return "verdict      accepted\n";
  return absl::StrCat(
      "verdict      rejected: ",
      absl::StrJoin(verdict.reasons, ", ", [](std::string* out, Reason reason) { out->append(ReasonName(reason)); }),
      "\n");
}

std::string TransformText(const RegistrationResult& result) {
  if (!result.T_target_source.has_value()) return "transform    none\n";
  const RigidTransform& T = *result.T_target_source;
  std::string text = "T_target_source (maps source coordinates to target coordinates, metres)\n";
  for (int row = 0; row < 4; ++row) {
    absl::StrAppendFormat(&text, "  %12.9f %12.9f %12.9f %14.9f\n", T(row, 0), T(row, 1), T(row, 2), T(row, 3));
  }
  absl::StrAppendFormat(&text, "motion       %.4f m, %.4f rad (%.3f deg)\n", T.translation().norm(), RotationAngle(T),
                        RotationAngle(T) * kDegreesPerRadian);
  return text;
}

std::string UncertaintyText(const RegistrationResult& result) {
  std::string text;
  if (result.covariance.has_value()) {
    const Vector6d sigma = result.covariance->diagonal().cwiseSqrt();
    absl::StrAppendFormat(
        &text, "sigma        rotation %.2g %.2g %.2g rad, translation %.2g %.2g %.2g m (x y z, target frame)\n",
        sigma[0], sigma[1], sigma[2], sigma[3], sigma[4], sigma[5]);
  }
  for (const DegenerateDirection& d : result.degenerate_directions) {
    const Vector6d& v = d.direction;
    absl::StrAppendFormat(&text, "degenerate   rotation (%.2f %.2f %.2f), translation (%.2f %.2f %.2f), sigma %.2g\n",
                          v[0], v[1], v[2], v[3], v[4], v[5], d.sigma);
  }
  return text;
}

// One line of evidence; nothing where the method does not compute the measure.
void AppendMeasure(const char* name, const std::optional<double>& value, const char* unit, std::string& text) {
  if (!value.has_value()) return;
  absl::StrAppendFormat(&text, "  %-22s %.4g%s\n", name, *value, unit);
}

std::string EvidenceText(const Evidence& e) {
  std::string text = "evidence\n";
  absl::StrAppendFormat(&text, "  %-22s %d source, %d target\n", "points", e.num_source_points, e.num_target_points);
  absl::StrAppendFormat(&text, "  %-22s %d source, %d target\n", "key points", e.num_source_keypoints,
                        e.num_target_keypoints);
  absl::StrAppendFormat(&text, "  %-22s %d, of these %d agree with the pose\n", "matches", e.num_matches,
                        e.num_inliers);
  absl::StrAppendFormat(&text, "  %-22s %d in %d attempts\n", "hypotheses", e.num_hypotheses, e.num_attempts);
  AppendMeasure("overlap of source", e.overlap_source, "", text);
  AppendMeasure("overlap of target", e.overlap_target, "", text);
  AppendMeasure("free-space agreement", e.free_space_agreement, "", text);
  AppendMeasure("image correlation", e.image_correlation, "", text);
  AppendMeasure("inlier fraction", e.inlier_fraction, "", text);
  AppendMeasure("residual RMSE", e.residual_rmse_m, " m", text);
  AppendMeasure("residual median", e.residual_median_m, " m", text);
  AppendMeasure("residual 90 %", e.residual_p90_m, " m", text);
  AppendMeasure("runner-up ratio", e.runner_up_ratio, "", text);
  return text;
}

std::string TimesText(const RegistrationResult& result) {
  std::string text = "time\n";
  for (const StageTime& time : result.stage_times) {
    absl::StrAppendFormat(&text, "  %-22s %9.2f ms\n", time.stage, time.seconds * 1e3);
  }
  absl::StrAppendFormat(&text, "  %-22s %9.2f ms\n", "total", result.total_seconds * 1e3);
  return text;
}

std::string NumberText(double value) { return std::isfinite(value) ? absl::StrFormat("%.4g", value) : "-"; }

}  // namespace

std::string RegistrationText(const RegistrationResult& result) {
  return absl::StrCat(VerdictText(result.verdict), TransformText(result), UncertaintyText(result),
                      EvidenceText(result.evidence), TimesText(result));
}

std::string EvaluationText(const Evaluation& evaluation) {
  std::string text = absl::StrFormat("%s\n%-13s %5s %5s %8s %8s %8s %7s %10s %10s %10s %10s %9s %9s\n",
                                     evaluation.dataset, "method", "pairs", "ok", "accepted", "wrong", "rejected",
                                     "no pose", "RMSE", "RMSE", "RMSE ok", "RMSE ok", "median", "p95");
  absl::StrAppendFormat(&text, "%-13s %5s %5s %8s %8s %8s %7s %10s %10s %10s %10s %9s %9s\n", "", "", "", "",
                        "accepted", "right", "", "m", "rad", "m", "rad", "s", "s");
  for (const MethodEvaluation& run : evaluation.methods) {
    const MethodSummary& s = run.summary;
    absl::StrAppendFormat(&text, "%-13s %5d %5d %8d %8d %8d %7d %10s %10s %10s %10s %9s %9s\n",
                          std::string(MethodName(run.method)), s.pairs, s.ok, s.accepted, s.accepted_wrong,
                          s.rejected_right, s.no_pose, NumberText(s.rmse_translation_m),
                          NumberText(s.rmse_rotation_rad), NumberText(s.rmse_ok_translation_m),
                          NumberText(s.rmse_ok_rotation_rad), NumberText(s.median_s), NumberText(s.p95_s));
    if (s.negatives > 0) {
      absl::StrAppendFormat(&text, "%-13s %d of %d negative pairs accepted\n", "", s.negatives_accepted, s.negatives);
    }
    if (s.failed_calls > 0) absl::StrAppendFormat(&text, "%-13s %d calls failed\n", "", s.failed_calls);
  }
  return text;
}

}  // namespace curvereg::cli
