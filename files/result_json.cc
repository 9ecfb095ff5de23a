// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/result_json.h"

#include <nlohmann/json.hpp>

#include <optional>

#include "core/methods/registration_names.h"

namespace curvereg {
namespace {

using nlohmann::ordered_json;

// Null: the method does not compute the measure.
ordered_json MeasureJson(const std::optional<double>& value) { return value ? ordered_json(*value) : ordered_json(); }

ordered_json DegenerateDirectionsJson(const std::vector<DegenerateDirection>& directions) {
  ordered_json json = ordered_json::array();
  for (const DegenerateDirection& d : directions) {
    const Vector6d& v = d.direction;
    json.push_back({{"rotation", {v[0], v[1], v[2]}}, {"translation", {v[3], v[4], v[5]}}, {"sigma", d.sigma}});
  }
  return json;
}

}  // namespace

std::string JsonText(const ordered_json& json, int indent) {
  return json.dump(indent, ' ', false, ordered_json::error_handler_t::replace);
}

ordered_json MatrixJson(const Eigen::MatrixXd& matrix) {
  ordered_json rows = ordered_json::array();
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    ordered_json row = ordered_json::array();
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) row.push_back(matrix(r, c));
    rows.push_back(std::move(row));
  }
  return rows;
}

ordered_json ReasonsJson(const std::vector<Reason>& reasons) {
  ordered_json names = ordered_json::array();
  for (const Reason reason : reasons) names.push_back(std::string(ReasonName(reason)));
  return names;
}

ordered_json EvidenceJson(const Evidence& evidence) {
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

ordered_json ResultJson(const RegistrationResult& result) {
  ordered_json stages = ordered_json::array();
  for (const StageTime& time : result.stage_times) stages.push_back({{"stage", time.stage}, {"seconds", time.seconds}});
  ordered_json json;
  json["accepted"] = result.verdict.accepted;
  json["reasons"] = ReasonsJson(result.verdict.reasons);
  json["T_target_source"] = result.T_target_source ? MatrixJson(result.T_target_source->matrix()) : ordered_json();
  json["covariance"] = result.covariance ? MatrixJson(*result.covariance) : ordered_json();
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
