// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/report_json.h"

#include "core/methods/registration_names.h"
#include "files/json.h"
#include "files/result_json.h"

namespace curvereg {
namespace {

Json OutcomeJson(const PairOutcome& outcome) {
  const TransformDifference error = PoseError(outcome);
  const RegistrationResult& result = outcome.result;
  Json json;
  json["source"] = outcome.source;
  json["target"] = outcome.target;
  json["accepted"] = result.verdict.accepted;
  json["ok"] = IsOk(outcome);
  json["translation_error_m"] = error.translation_m;
  json["rotation_error_rad"] = error.rotation_rad;
  json["seconds"] = outcome.seconds;
  json["negative"] = !outcome.true_T_target_source.has_value();
  json["overlap"] = outcome.overlap < 0.0 ? Json() : Json(outcome.overlap);
  json["error"] = outcome.error.empty() ? Json() : Json(outcome.error);
  json["reasons"] = ReasonsJson(result.verdict.reasons);
  json["T_target_source"] = result.T_target_source ? MatrixJson(result.T_target_source->matrix()) : Json();
  json["evidence"] = EvidenceJson(result.evidence);
  return json;
}

Json MethodJson(const MethodEvaluation& run) {
  const MethodSummary& s = run.summary;
  Json details = Json::Array();
  for (const PairOutcome& outcome : run.outcomes) details.Append(OutcomeJson(outcome));
  return {{"method", std::string(MethodName(run.method))},
          {"pairs", s.pairs},
          {"ok", s.ok},
          {"accepted", s.accepted},
          {"accepted_wrong", s.accepted_wrong},
          {"rejected_right", s.rejected_right},
          {"no_pose", s.no_pose},
          {"failed_calls", s.failed_calls},
          {"negatives", s.negatives},
          {"negatives_accepted", s.negatives_accepted},
          {"rmse_translation_m", s.rmse_translation_m},
          {"rmse_rotation_rad", s.rmse_rotation_rad},
          {"median_translation_m", s.median_translation_m},
          {"median_rotation_rad", s.median_rotation_rad},
          {"rmse_ok_translation_m", s.rmse_ok_translation_m},
          {"rmse_ok_rotation_rad", s.rmse_ok_rotation_rad},
          {"median_ok_translation_m", s.median_ok_translation_m},
          {"median_ok_rotation_rad", s.median_ok_rotation_rad},
          {"median_s", s.median_s},
          {"p95_s", s.p95_s},
          {"details", std::move(details)}};
}

}  // namespace

std::string EvaluationJson(const Evaluation& evaluation, int indent) {
  Json methods = Json::Array();
  for (const MethodEvaluation& run : evaluation.methods) methods.Append(MethodJson(run));
  return JsonText({{"dataset", evaluation.dataset}, {"methods", std::move(methods)}}, indent);
}

}  // namespace curvereg
