// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/result_json.h"
#include "files/json.h"

#include <optional>

#include "core/methods/registration_names.h"

namespace curvereg {
namespace {

// Null: the method does not compute the measure.
Json MeasureJson(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

Json DegenerateDirectionsJson(const std::vector<DegenerateDirection>& directions) {
  Json json = Json::Array();
  for (const DegenerateDirection& d : directions) {
    const Vector6d& v = d.direction;
    json.Append({{"rotation", {v[0], v[1], v[2]}}, {"translation", {v[3], v[4], v[5]}}, {"sigma", d.sigma}});
  }
  return json;
}

}  // namespace

Json MatrixJson(const Eigen::MatrixXd& matrix) {
  Json rows = Json::Array();
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    Json row = Json::Array();
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) row.Append(matrix(r, c));
    rows.Append(std::move(row));
  }
  return rows;
}

Json ReasonsJson(const std::vector<Reason>& reasons) {
  Json names = Json::Array();
  for (const Reason reason : reasons) names.Append(std::string(ReasonName(reason)));
  return names;
}

Json EvidenceJson(const Evidence& evidence) {
  return {{"num_source_points", evidence.num_source_points},
          {"num_target_points", evidence.num_target_points},
          {"num_source_keypoints", evidence.num_source_keypoints},
          {"num_target_keypoints", evidence.num_target_keypoints},
          {"num_matches", evidence.num_matches},
          {"num_inliers", evidence.num_inliers},
          {"num_hypotheses", evidence.num_hypotheses},
          {"num_attempts", evidence.num_attempts},
          {"overlap_source", MeasureJson(evidence.overlap_source)},
          {"overlap_target", MeasureJson(evidence.overlap_target)},
          {"free_space_agreement", MeasureJson(evidence.free_space_agreement)},
          {"image_correlation", MeasureJson(evidence.image_correlation)},
          {"inlier_fraction", MeasureJson(evidence.inlier_fraction)},
          {"residual_rmse_m", MeasureJson(evidence.residual_rmse_m)},
          {"residual_median_m", MeasureJson(evidence.residual_median_m)},
          {"residual_p90_m", MeasureJson(evidence.residual_p90_m)},
          {"runner_up_ratio", MeasureJson(evidence.runner_up_ratio)}};
}

Json ResultJson(const RegistrationResult& result) {
  Json stages = Json::Array();
  for (const StageTime& time : result.stage_times) stages.Append({{"stage", time.stage}, {"seconds", time.seconds}});
  Json json;
  json["accepted"] = result.verdict.accepted;
  json["reasons"] = ReasonsJson(result.verdict.reasons);
  json["T_target_source"] = result.T_target_source ? MatrixJson(result.T_target_source->matrix()) : Json();
  json["covariance"] = result.covariance ? MatrixJson(*result.covariance) : Json();
  json["degenerate_directions"] = DegenerateDirectionsJson(result.degenerate_directions);
  json["evidence"] = EvidenceJson(result.evidence);
  json["stage_times"] = std::move(stages);
  json["total_seconds"] = result.total_seconds;
  json["seed"] = result.seed;
  json["options_digest"] = result.options_digest;
  json["source_digest"] = result.source_digest;
  json["target_digest"] = result.target_digest;
  json["build_id"] = result.build_id;
  return json;
}

}  // namespace curvereg
