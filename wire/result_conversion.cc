// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/result_conversion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "wire/duration.h"
#include "wire/error.h"
#include "wire/evidence_conversion.h"
#include "wire/geometry_conversion.h"

namespace curvereg::wire {
namespace {

constexpr std::array<std::pair<Reason, v1::VerdictReason>, 10> kReasons = {
    {{Reason::kNotRun, v1::VERDICT_REASON_NOT_RUN},
     {Reason::kTooFewPoints, v1::VERDICT_REASON_TOO_FEW_POINTS},
     {Reason::kTooFewFeatures, v1::VERDICT_REASON_TOO_FEW_FEATURES},
     {Reason::kNoConsensus, v1::VERDICT_REASON_NO_CONSENSUS},
     {Reason::kResidualTooHigh, v1::VERDICT_REASON_RESIDUAL_TOO_HIGH},
     {Reason::kOverlapTooLow, v1::VERDICT_REASON_OVERLAP_TOO_LOW},
     {Reason::kFreeSpaceViolated, v1::VERDICT_REASON_FREE_SPACE_VIOLATED},
     {Reason::kAmbiguous, v1::VERDICT_REASON_AMBIGUOUS},
     {Reason::kDegenerateDirection, v1::VERDICT_REASON_DEGENERATE_DIRECTION},
     {Reason::kDeadline, v1::VERDICT_REASON_DEADLINE}}};

v1::VerdictReason ReasonToWire(Reason reason) {
  for (const auto& [ours, theirs] : kReasons) {
    if (ours == reason) return theirs;
  }
  return v1::VERDICT_REASON_UNSPECIFIED;
}

std::optional<Reason> ReasonFromWire(int reason) {
  for (const auto& [ours, theirs] : kReasons) {
    if (theirs == reason) return ours;
  }
  return std::nullopt;
}

absl::StatusOr<Verdict> VerdictFromWire(const v1::Verdict& message) {
  Verdict verdict;
  verdict.accepted = message.accepted();
  verdict.reasons.clear();
  for (int i = 0; i < message.reasons_size(); ++i) {
    const std::optional<Reason> reason = ReasonFromWire(message.reasons(i));
    if (!reason.has_value()) return FieldError(absl::StrCat("reasons[", i, "]"), "not a known reason");
    verdict.reasons.push_back(*reason);
  }
  if (verdict.accepted != verdict.reasons.empty()) {
    return FieldError("reasons", "must be empty exactly when the pose is accepted");
  }
  return verdict;
}

absl::StatusOr<DegenerateDirection> DirectionFromWire(const v1::DegenerateDirection& message) {
  if (message.direction_size() != 6) return FieldError("direction", "not 6 numbers");
  DegenerateDirection result;
  for (int i = 0; i < 6; ++i) result.direction[i] = message.direction(i);
  if (!(std::abs(result.direction.norm() - 1.0) <= 0.01)) return FieldError("direction", "not a unit vector");
  if (!(message.sigma() >= 0.0)) return FieldError("sigma", "below 0");
  result.sigma = message.sigma();
  return result;
}

absl::Status ReadPose(const v1::RegistrationResult& message, RegistrationResult& result) {
  if (message.has_t_target_source()) {
    absl::StatusOr<RigidTransform> T_target_source = FromWire(message.t_target_source());
    if (!T_target_source.ok()) return WithinField("t_target_source", T_target_source.status());
    result.T_target_source = *T_target_source;
  }
  if (message.has_covariance()) {
    absl::StatusOr<Matrix6d> covariance = FromWire(message.covariance());
    if (!covariance.ok()) return WithinField("covariance", covariance.status());
    result.covariance = *covariance;
  }
  for (int i = 0; i < message.degenerate_directions_size(); ++i) {
    absl::StatusOr<DegenerateDirection> direction = DirectionFromWire(message.degenerate_directions(i));
    if (!direction.ok()) return WithinField(absl::StrCat("degenerate_directions[", i, "]"), direction.status());
    result.degenerate_directions.push_back(*direction);
  }
  return absl::OkStatus();
}

absl::Status ReadTimes(const v1::RegistrationResult& message, RegistrationResult& result) {
  for (int i = 0; i < message.stage_times_size(); ++i) {
    const std::optional<double> seconds = SecondsOf(message.stage_times(i).duration());
    if (!seconds.has_value() || *seconds < 0.0) {
      return FieldError(absl::StrCat("stage_times[", i, "].duration"), "out of range");
    }
    result.stage_times.push_back({message.stage_times(i).stage(), *seconds});
  }
  const std::optional<double> total = SecondsOf(message.total_time());
  if (!total.has_value() || *total < 0.0) return FieldError("total_time", "out of range");
  result.total_seconds = *total;
  return absl::OkStatus();
}

// Of a measure that was computed; summaries carry floats.
std::optional<float> Brief(const std::optional<double>& value) {
  if (!value.has_value() || *value < 0.0 || std::isnan(*value)) return std::nullopt;
  return static_cast<float>(*value);
}

void SetPose(const RegistrationResult& result, v1::RegistrationSummary& summary) {
  if (result.T_target_source.has_value()) {
    for (int i = 0; i < 3; ++i) summary.add_translation(result.T_target_source->translation()[i]);
    const v1::Quaternion rotation = ToWire(*result.T_target_source).rotation();
    for (const double value : {rotation.x(), rotation.y(), rotation.z(), rotation.w()}) {
      summary.add_rotation(static_cast<float>(value));
    }
  }
  if (result.covariance.has_value()) {
    for (int i = 0; i < 6; ++i) {
      summary.add_sigma(static_cast<float>(std::sqrt(std::max((*result.covariance)(i, i), 0.0))));
    }
  }
}

}  // namespace

v1::RegistrationResult ToWire(const RegistrationResult& result) {
  v1::RegistrationResult message;
  if (result.T_target_source) *message.mutable_t_target_source() = ToWire(*result.T_target_source);
  if (result.covariance) *message.mutable_covariance() = ToWire(*result.covariance);
  message.mutable_verdict()->set_accepted(result.verdict.accepted);
  for (const Reason reason : result.verdict.reasons) message.mutable_verdict()->add_reasons(ReasonToWire(reason));
  for (const DegenerateDirection& direction : result.degenerate_directions) {
    v1::DegenerateDirection* added = message.add_degenerate_directions();
    for (int i = 0; i < 6; ++i) added->add_direction(direction.direction[i]);
    added->set_sigma(direction.sigma);
  }
  *message.mutable_evidence() = ToWire(result.evidence);
  for (const StageTime& time : result.stage_times) {
    v1::StageTime* added = message.add_stage_times();
    added->set_stage(time.stage);
    *added->mutable_duration() = ToWire(time.seconds);
  }
  *message.mutable_total_time() = ToWire(result.total_seconds);
  message.set_seed(result.seed);
  message.set_options_digest(result.options_digest);
  message.set_source_digest(result.source_digest);
  message.set_target_digest(result.target_digest);
  message.set_build_id(result.build_id);
  return message;
}

absl::StatusOr<RegistrationResult> FromWire(const v1::RegistrationResult& message) {
  RegistrationResult result;
  if (!message.has_verdict()) return FieldError("verdict", "missing");
  absl::StatusOr<Verdict> verdict = VerdictFromWire(message.verdict());
  if (!verdict.ok()) return WithinField("verdict", verdict.status());
  result.verdict = *std::move(verdict);
  if (absl::Status status = ReadPose(message, result); !status.ok()) return status;
  if (result.verdict.accepted && !result.T_target_source)
    return FieldError("t_target_source", "missing, though accepted");
  absl::StatusOr<Evidence> evidence = FromWire(message.evidence());
  if (!evidence.ok()) return WithinField("evidence", evidence.status());
  result.evidence = *evidence;
  if (absl::Status status = ReadTimes(message, result); !status.ok()) return status;
  result.seed = message.seed();
  result.options_digest = message.options_digest();
  result.source_digest = message.source_digest();
  result.target_digest = message.target_digest();
  result.build_id = message.build_id();
  return result;
}

v1::RegistrationSummary ToSummary(const RegistrationResult& result) {
  v1::RegistrationSummary summary;
  summary.set_accepted(result.verdict.accepted);
  // Each reason once and in the order of the list: what bounds the size.
  for (const auto& [ours, theirs] : kReasons) {
    const std::vector<Reason>& reasons = result.verdict.reasons;
    if (std::find(reasons.begin(), reasons.end(), ours) != reasons.end()) summary.add_reasons(theirs);
  }
  SetPose(result, summary);
  const Evidence& evidence = result.evidence;
  if (const auto overlap = Brief(std::min(evidence.overlap_source, evidence.overlap_target))) {
    summary.set_overlap(*overlap);
  }
  if (const auto rmse = Brief(evidence.residual_rmse_m)) summary.set_residual_rmse_m(*rmse);
  if (const auto ratio = Brief(evidence.runner_up_ratio)) summary.set_runner_up_ratio(*ratio);
  summary.set_inlier_count(static_cast<uint32_t>(std::max(evidence.num_inliers, 0)));
  summary.set_degenerate_direction_count(static_cast<uint32_t>(result.degenerate_directions.size()));
  constexpr double kMaxMilliseconds = std::numeric_limits<uint32_t>::max();
  const double milliseconds = std::round(result.total_seconds * 1e3);
  if (milliseconds > 0.0) summary.set_total_ms(static_cast<uint32_t>(std::min(milliseconds, kMaxMilliseconds)));
  return summary;
}

}  // namespace curvereg::wire
