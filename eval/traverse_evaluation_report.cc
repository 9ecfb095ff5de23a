// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/traverse_evaluation_report.h"

#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/methods/registration_names.h"
#include "eval/distribution.h"
#include "eval/report_files.h"
#include "eval/report_html.h"
#include "eval/report_pictures.h"
#include "files/atomic_file.h"
#include "files/json.h"
#include "files/result_json.h"

namespace curvereg {
namespace {

Json StatisticsJson(const ErrorStatistics& statistics) {
  return {{"rmse", statistics.rmse}, {"mean", statistics.mean}, {"median", statistics.median}, {"max", statistics.max}};
}

Json ThicknessJson(const SurfaceThickness::Result& thickness) {
  return {{"median_m", thickness.median_m}, {"p90_m", thickness.p90_m}, {"cells", thickness.num_cells}};
}

Json TrajectoryJson(const MeasuredTrajectory& trajectory) {
  Json json;
  json["segments"] = trajectory.num_segments;
  json["measured_scans"] = trajectory.num_measured;
  if (trajectory.errors) {
    json["path_length_m"] = trajectory.errors->path_length_m;
    json["ape_m"] = StatisticsJson(trajectory.errors->ape_m);
    json["drift_m"] = StatisticsJson(trajectory.errors->drift_m);
    json["drift_at_end_m"] = trajectory.errors->drift_at_end_m;
    json["rpe_m"] = StatisticsJson(trajectory.errors->rpe_m);
    json["rpe_rad"] = StatisticsJson(trajectory.errors->rpe_rad);
  }
  json["surface_thickness"] = ThicknessJson(trajectory.thickness);
  return json;
}

std::string Millimetres(double metres) { return std::isfinite(metres) ? absl::StrFormat("%.1f", 1e3 * metres) : "-"; }

// One line of the table: what it is, then one cell for each trajectory.
using Row = std::pair<std::string, std::vector<std::string>>;

std::vector<Row> Rows(const TraverseEvaluation& evaluation) {
  std::vector<Row> rows;
  const auto add = [&](const std::string& name, const auto& value) {
    rows.push_back({name, {value(evaluation.tracked), value(evaluation.optimised)}});
  };
  const auto add_error = [&](const std::string& name, const auto& of) {
    add(name, [&](const MeasuredTrajectory& t) { return t.errors ? Millimetres(of(*t.errors)) : std::string("-"); });
  };
  add("segments", [](const MeasuredTrajectory& t) { return absl::StrCat(t.num_segments); });
  add("scans measured", [](const MeasuredTrajectory& t) { return absl::StrCat(t.num_measured); });
  add_error("APE RMSE [mm]", [](const TrajectoryErrors& e) { return e.ape_m.rmse; });
  add_error("APE max [mm]", [](const TrajectoryErrors& e) { return e.ape_m.max; });
  add_error("drift RMSE [mm]", [](const TrajectoryErrors& e) { return e.drift_m.rmse; });
  add_error("drift at end [mm]", [](const TrajectoryErrors& e) { return e.drift_at_end_m; });
  add_error("RPE RMSE [mm]", [](const TrajectoryErrors& e) { return e.rpe_m.rmse; });
  add_error("RPE RMSE [mrad]", [](const TrajectoryErrors& e) { return e.rpe_rad.rmse; });
  add("map thickness [mm]", [](const MeasuredTrajectory& t) { return Millimetres(t.thickness.median_m); });
  return rows;
}

std::string Headline(const TraverseEvaluation& evaluation) {
  std::string text = absl::StrCat(evaluation.num_scans, " scans by ", std::string(MethodName(evaluation.method)), ": ",
                                  evaluation.num_accepted_links, " of ", evaluation.links.size(), " links accepted, ",
                                  evaluation.num_accepted_wrong_links, " of them wrong; the optimisation rejected ",
                                  evaluation.num_given_up_links, evaluation.converged ? "" : " and did not converge");
  absl::StrAppendFormat(&text, ". Tracking: median %.3f s a scan; optimisation %.3f s.",
                        Quantile(evaluation.track_seconds, 0.5), evaluation.optimise_seconds);
  if (evaluation.true_thickness) {
    absl::StrAppend(&text, " Map thickness at the true poses: ", Millimetres(evaluation.true_thickness->median_m),
                    " mm.");
  }
  return text;
}

std::string TableHtml(const TraverseEvaluation& evaluation) {
  std::string html = "<table>\n<tr><th></th><th>tracked</th><th>optimised</th></tr>\n";
  for (const auto& [name, cells] : Rows(evaluation)) {
    absl::StrAppend(&html, "<tr><td>", name, "</td><td>", cells[0], "</td><td>", cells[1], "</td></tr>\n");
  }
  return absl::StrCat(
      "<p>", Escaped(Headline(evaluation)), "</p>\n", html, "</table>\n",
      "<p>APE: after the best rigid alignment. Drift: with the first pose aligned to its true pose. RPE: ",
      "from scan to scan. Map thickness: median standard deviation across surfaces that several scans ",
      "observed.</p>\n");
}

// The poses of the measured segment in the frame of the ground truth, with the first pose at its true pose.
std::vector<std::optional<RigidTransform>> PlacedPoses(const MeasuredTrajectory& trajectory, const Dataset& dataset) {
  std::vector<std::optional<RigidTransform>> placed(trajectory.poses.size());
  const int segment = trajectory.measured_segment;
  std::optional<RigidTransform> T_world_segment;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const TrajectoryPose& pose = trajectory.poses[i];
    if (pose.segment != segment || T_world_segment || !dataset.T_world_scan[i]) continue;
    T_world_segment = *dataset.T_world_scan[i] * pose.T_segment_scan.inverse();
  }
  for (std::size_t i = 0; i < placed.size(); ++i) {
    if (trajectory.poses[i].segment != segment) continue;
    placed[i] = T_world_segment.value_or(RigidTransform::Identity()) * trajectory.poses[i].T_segment_scan;
  }
  return placed;
}

}  // namespace

std::string TraverseEvaluationJson(const TraverseEvaluation& evaluation, int indent) {
  Json json;
  json["dataset"] = evaluation.dataset;
  json["method"] = std::string(MethodName(evaluation.method));
  json["scans"] = evaluation.num_scans;
  json["links"] = evaluation.links.size();
  json["accepted_links"] = evaluation.num_accepted_links;
  json["accepted_wrong_links"] = evaluation.num_accepted_wrong_links;
  json["given_up_links"] = evaluation.num_given_up_links;
  json["converged"] = evaluation.converged;
  json["median_track_s"] = Quantile(evaluation.track_seconds, 0.5);
  json["p95_track_s"] = Quantile(evaluation.track_seconds, 0.95);
  json["optimise_s"] = evaluation.optimise_seconds;
  json["tracked"] = TrajectoryJson(evaluation.tracked);
  json["optimised"] = TrajectoryJson(evaluation.optimised);
  json["true_surface_thickness"] = evaluation.true_thickness ? ThicknessJson(*evaluation.true_thickness) : Json();
  return JsonText(json, indent);
}

std::string TraverseEvaluationText(const TraverseEvaluation& evaluation) {
  std::string text = absl::StrFormat("%s\n%s\n%-20s %10s %10s\n", evaluation.dataset, Headline(evaluation), "",
                                     "tracked", "optimised");
  for (const auto& [name, cells] : Rows(evaluation)) {
    absl::StrAppendFormat(&text, "%-20s %10s %10s\n", name, cells[0], cells[1]);
  }
  return text;
}

absl::StatusOr<std::string> WriteTraverseEvaluationReport(const TraverseEvaluation& evaluation, const Dataset& dataset,
                                                          const std::string& folder, const ReportOptions& options) {
  const auto optimised = PlacedPoses(evaluation.optimised, dataset);
  absl::Status status = WriteFileAtomically(folder + "/traverse.json", TraverseEvaluationJson(evaluation, 1) + "\n");
  status.Update(WriteScanPoses(folder + "/trajectory_truth.tum", dataset.T_world_scan));
  status.Update(WriteScanPoses(folder + "/trajectory_tracked.tum", PlacedPoses(evaluation.tracked, dataset)));
  status.Update(WriteScanPoses(folder + "/trajectory_optimised.tum", optimised));
  if (status.ok()) status = WriteMergedMap(folder + "/map_optimised.ply", dataset, optimised, options);
  if (!status.ok()) return status;
  return WritePage(folder, options.figures, Drawing::kTraverseEvaluation,
                   {.title = "Traverse of " + evaluation.dataset, .summary = TableHtml(evaluation)});
}

}  // namespace curvereg
