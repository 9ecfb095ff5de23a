// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/traverse_text.h"

#include <cmath>
#include <variant>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/time/time.h"
#include "core/base/small_matrices.h"
#include "core/methods/registration_names.h"
#include "files/json.h"
#include "files/result_json.h"

namespace curvereg::cli {
namespace {

Json MeasureJson(double value) { return value >= 0.0 ? Json(value) : Json(nullptr); }

std::string Measure(double value, int decimals) {
  return value >= 0.0 ? absl::StrFormat("%.*f", decimals, value) : "-";
}

std::string TimeText(std::chrono::system_clock::time_point time) {
  return absl::FormatTime(absl::RFC3339_full, absl::FromChrono(time), absl::UTCTimeZone());
}

Json TransformJson(const RigidTransform& T) { return MatrixJson(T.matrix()); }

Json LinksJson(const std::vector<LinkSummary>& links) {
  Json json = Json::Array();
  for (const LinkSummary& link : links) json.Append(LinkJson(link));
  return json;
}

// What the table shows of a scan's links: the accepted one, else the last that was tried.
const LinkSummary* TellingLink(const ScanResult& result) {
  for (const LinkSummary& link : result.links) {
    if (link.accepted) return &link;
  }
  return result.links.empty() ? nullptr : &result.links.back();
}

std::string VerdictText(const ScanResult& result) {
  if (result.pose.origin == PoseOrigin::kRegistered) return "accepted";
  const std::string word = result.pose.origin == PoseOrigin::kPrior ? "prior" : "new segment";
  const LinkSummary* link = TellingLink(result);
  if (link == nullptr || link->reasons.empty()) return word;
  return absl::StrCat(
      word, " (",
      absl::StrJoin(link->reasons, ", ", [](std::string* out, Reason reason) { out->append(ReasonName(reason)); }),
      ")");
}

std::string EventText(const ScanResult& result) { return ScanResultRow(result); }

std::string EventText(const TrajectoryRevision& revision) {
  return absl::StrCat("  poses of ", revision.poses.size(), " scans revised, version ", revision.version, "\n");
}

std::string EventText(const SegmentsJoined& joined) {
  return absl::StrCat("  segment ", joined.joined_segment, " joined segment ", joined.segment, "\n");
}

std::string EventText(const LinksFound& found) {
  std::string text;
  for (const LinkSummary& link : found.links) {
    absl::StrAppend(&text, "  ", link.loop_closure ? "loop closure " : "link ", link.source, " -> ", link.target,
                    link.accepted ? " accepted\n" : " rejected\n");
  }
  return text;
}

Json WhatJson(const ScanResult& result) { return {{"result", ScanResultJson(result)}}; }

Json WhatJson(const TrajectoryRevision& revision) {
  Json poses = Json::Array();
  for (const TrajectoryPose& pose : revision.poses) poses.Append(PoseJson(pose));
  return {{"revision", {{"version", revision.version}, {"poses", std::move(poses)}}}};
}

Json WhatJson(const SegmentsJoined& joined) {
  return {{"joined",
           {{"segment", joined.segment},
            {"joined_segment", joined.joined_segment},
            {"T_segment_joined", TransformJson(joined.T_segment_joined)}}}};
}

Json WhatJson(const LinksFound& found) { return {{"links", LinksJson(found.links)}}; }

}  // namespace

std::string OriginName(PoseOrigin origin) {
  switch (origin) {
    case PoseOrigin::kSegmentStart:
      return "segment_start";
    case PoseOrigin::kRegistered:
      return "registered";
    case PoseOrigin::kPrior:
      return "prior";
  }
  return "unknown";
}

Json PoseJson(const TrajectoryPose& pose) {
  return {{"sequence_number", pose.sequence_number},
          {"time_ns", pose.time_ns ? Json(*pose.time_ns) : Json(nullptr)},
          {"segment", pose.segment},
          {"origin", OriginName(pose.origin)},
          {"T_segment_scan", TransformJson(pose.T_segment_scan)},
          {"covariance", pose.covariance ? MatrixJson(*pose.covariance) : Json(nullptr)}};
}

Json LinkJson(const LinkSummary& link) {
  return {{"source", link.source},
          {"target", link.target},
          {"loop_closure", link.loop_closure},
          {"accepted", link.accepted},
          {"reasons", ReasonsJson(link.reasons)},
          {"T_target_source", link.T_target_source ? TransformJson(*link.T_target_source) : Json(nullptr)},
          {"sigma", link.sigma ? Json(std::vector<double>(link.sigma->begin(), link.sigma->end())) : Json(nullptr)},
          {"overlap", MeasureJson(link.overlap)},
          {"residual_rmse_m", MeasureJson(link.residual_rmse_m)},
          {"runner_up_ratio", MeasureJson(link.runner_up_ratio)},
          {"seconds", link.seconds}};
}

Json ScanResultJson(const ScanResult& result) {
  return {{"sequence_number", result.sequence_number},
          {"pose", PoseJson(result.pose)},
          {"links", LinksJson(result.links)},
          {"result", result.result ? ResultJson(*result.result) : Json(nullptr)},
          {"latency_s", result.latency_s}};
}

Json TraverseJson(const RemoteTraverse& traverse) {
  const RegistrationOptions& registration = traverse.settings.registration;
  return {{"name", traverse.name},
          {"create_time", TimeText(traverse.create_time)},
          {"method", std::string(MethodName(registration.method))},
          {"seed", registration.seed},
          {"reorder_window", traverse.settings.reorder_window},
          {"optimize_on_the_fly", traverse.settings.optimize_on_the_fly},
          {"next_sequence_number", traverse.next_sequence_number},
          {"num_registered_scans", traverse.num_registered_scans},
          {"num_segments", traverse.num_segments},
          {"trajectory_version", traverse.trajectory_version},
          {"path_length_m", traverse.path_length_m}};
}

Json EventJson(const TraverseEvent& event) {
  Json json = {{"event", event.number}, {"time", TimeText(event.time)}};
  json.Update(std::visit([](const auto& what) { return WhatJson(what); }, event.what));
  return json;
}

Json OptimizationJson(const OptimizationOutcome& outcome) {
  return {{"version", outcome.version},
          {"num_links", outcome.num_links},
          {"num_loop_closures", outcome.num_loop_closures},
          {"num_rejected_links", outcome.num_rejected_links},
          {"max_translation_change_m", outcome.max_translation_change_m},
          {"converged", outcome.converged}};
}

std::string OptimizationText(const OptimizationOutcome& outcome) {
  return absl::StrFormat(
      "optimised with %d links, %d loop closures found, %d outlier links; largest change of a position %.4f m%s\n",
      outcome.num_links, outcome.num_loop_closures, outcome.num_rejected_links, outcome.max_translation_change_m,
      outcome.converged ? "" : ", not converged: optimise again");
}

std::optional<Eigen::Matrix3d> PositionCovariance(const TrajectoryPose& pose) {
  if (!pose.covariance) return std::nullopt;
  const Eigen::Vector3d p = pose.T_segment_scan.translation();
  Eigen::Matrix<double, 3, 6> J;
  J << 0.0, p.z(), -p.y(), 1.0, 0.0, 0.0,  //
      -p.z(), 0.0, p.x(), 0.0, 1.0, 0.0,   //
      p.y(), -p.x(), 0.0, 0.0, 0.0, 1.0;
  return Eigen::Matrix3d(J * *pose.covariance * J.transpose());
}

std::optional<double> PositionSigma(const TrajectoryPose& pose) {
  const std::optional<Eigen::Matrix3d> covariance = PositionCovariance(pose);
  if (!covariance) return std::nullopt;
  return std::sqrt(std::max(EigenvaluesOf(*covariance).maxCoeff(), 0.0));
}

std::string ScanResultHeader() {
  return absl::StrFormat("%6s %3s %10s %10s %10s %7s %9s %9s %8s  %s\n", "scan", "seg", "x [m]", "y [m]", "z [m]",
                         "overlap", "rmse [m]", "sigma [m]", "time [s]", "verdict");
}

std::string ScanResultRow(const ScanResult& result) {
  const Eigen::Vector3d place = result.pose.T_segment_scan.translation();
  const LinkSummary* link = TellingLink(result);
  return absl::StrFormat("%6d %3d %10.3f %10.3f %10.3f %7s %9s %9s %8.3f  %s\n", result.sequence_number,
                         result.pose.segment, place.x(), place.y(), place.z(),
                         link == nullptr ? "-" : Measure(link->overlap, 3),
                         link == nullptr ? "-" : Measure(link->residual_rmse_m, 4),
                         Measure(PositionSigma(result.pose).value_or(-1.0), 4), result.latency_s, VerdictText(result));
}

std::string EventText(const TraverseEvent& event) {
  return std::visit([](const auto& what) { return EventText(what); }, event.what);
}

}  // namespace curvereg::cli
