// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/traverse_report.h"

#include <filesystem>
#include <map>
#include <set>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "cli/traverse_text.h"
#include "cli/traverse_trajectory.h"
#include "core/methods/registration_names.h"
#include "eval/report_html.h"
#include "eval/report_pictures.h"
#include "files/atomic_file.h"
#include "files/cloud_file.h"
#include "files/json.h"
#include "files/result_json.h"

namespace curvereg::cli {
namespace {

namespace fs = std::filesystem;
Json ScanJson(const TrajectoryPose& pose, const ScanResult* result) {
  Json json = PoseJson(pose);
  const std::optional<Eigen::Matrix3d> covariance = PositionCovariance(pose);
  json["position_covariance"] = covariance ? MatrixJson(*covariance) : Json(nullptr);
  json["links"] = Json::Array();
  if (result == nullptr) return json;
  for (const LinkSummary& link : result->links) json["links"].Append(LinkJson(link));
  json["latency_s"] = result->latency_s;
  return json;
}

std::map<uint64_t, const ScanResult*> ResultsByNumber(const TraverseRecord& record) {
  std::map<uint64_t, const ScanResult*> results;
  for (const ScanResult& result : record.results) results[result.sequence_number] = &result;
  return results;
}

std::string RecordJson(const TraverseRecord& record) {
  Json json = TraverseJson(record.traverse);
  json["version"] = record.trajectory.version;
  json["largest_segment"] = LargestSegment(record.trajectory.poses);
  json["scans"] = Json::Array();
  const std::map<uint64_t, const ScanResult*> results = ResultsByNumber(record);
  for (const TrajectoryPose& pose : record.trajectory.poses) {
    const auto found = results.find(pose.sequence_number);
    json["scans"].Append(ScanJson(pose, found == results.end() ? nullptr : found->second));
  }
  json["later_links"] = Json::Array();
  for (const LinkSummary& link : record.later_links) json["later_links"].Append(LinkJson(link));
  return JsonText(json, 1) + "\n";
}

std::string Cell(const std::string& content) { return absl::StrCat("<td>", content, "</td>"); }

std::string Measure(double value) { return value >= 0.0 ? absl::StrFormat("%.4g", value) : "–"; }

std::string Row(const TrajectoryPose& pose, const ScanResult* result) {
  const Eigen::Vector3d place = pose.T_segment_scan.translation();
  std::string verdicts;
  double overlap = -1.0, residual = -1.0;
  if (result != nullptr) {
    for (const LinkSummary& link : result->links) {
      const std::string reasons =
          absl::StrJoin(link.reasons, ", ", [](std::string* out, Reason reason) { out->append(ReasonName(reason)); });
      absl::StrAppend(&verdicts, verdicts.empty() ? "" : "; ", "on ", link.target,
                      link.accepted ? " accepted" : " rejected: ", reasons);
      if (link.accepted && overlap < 0.0) {
        overlap = link.overlap;
        residual = link.residual_rmse_m;
      }
    }
  }
  const bool is_carried = pose.origin == PoseOrigin::kPrior;
  return absl::StrCat("<tr>", Cell(absl::StrCat(pose.sequence_number)), Cell(absl::StrCat(pose.segment)),
                      Cell(absl::StrFormat("%.3f", place.x())), Cell(absl::StrFormat("%.3f", place.y())),
                      Cell(absl::StrFormat("%.3f", place.z())), Cell(Measure(PositionSigma(pose).value_or(-1.0))),
                      Cell(Measure(overlap)), Cell(Measure(residual)),
                      is_carried ? "<td class=\"bad\">prior</td>" : Cell(OriginName(pose.origin)),
                      "<td class=\"text\">", Escaped(verdicts), "</td></tr>\n");
}

std::string ScanTable(const TraverseRecord& record) {
  std::string table = absl::StrCat(
      "<h2>Scans</h2>\n<table>\n<tr><th>scan</th><th>segment</th><th>x [m]</th><th>y [m]</th><th>z [m]</th>",
      "<th>sigma [m]</th><th>overlap</th><th>rmse [m]</th><th>pose</th><th>links at registration</th></tr>\n");
  const std::map<uint64_t, const ScanResult*> results = ResultsByNumber(record);
  for (const TrajectoryPose& pose : record.trajectory.poses) {
    const auto found = results.find(pose.sequence_number);
    absl::StrAppend(&table, Row(pose, found == results.end() ? nullptr : found->second));
  }
  return absl::StrCat(table, "</table>\n");
}

std::string Summary(const TraverseRecord& record) {
  int num_loops = 0;
  for (const LinkSummary& link : record.later_links) num_loops += link.loop_closure && link.accepted ? 1 : 0;
  return absl::StrCat("<p>", record.trajectory.poses.size(), " scans, ", record.traverse.num_segments, " segments, ",
                      absl::StrFormat("%.2f m", record.traverse.path_length_m), " driven, ", num_loops,
                      " loop closures, version ", record.trajectory.version, " of the trajectory. Method: ",
                      std::string(MethodName(record.traverse.settings.registration.method)), ".</p>\n");
}

// Of an earlier run: segments are joined, and a map may be no more.
void RemoveData(const std::string& folder) {
  std::error_code error;
  std::vector<fs::path> stale = {fs::path(folder) / "map.ply"};
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    const bool is_trajectory = name.starts_with("trajectory_") && name.ends_with(".tum");
    if (is_trajectory && absl::ascii_isdigit(static_cast<unsigned char>(name[11]))) stale.push_back(entry.path());
  }
  for (const fs::path& path : stale) fs::remove(path, error);
}

absl::Status WriteData(const TraverseRecord& record, const std::string& folder) {
  RemoveData(folder);
  absl::Status status = WriteFileAtomically(folder + "/report.json", RecordJson(record));
  std::set<int> segments;
  for (const TrajectoryPose& pose : record.trajectory.poses) segments.insert(pose.segment);
  for (const int segment : segments) {
    const absl::StatusOr<std::string> text =
        TrajectoryText(PosesOf(record.trajectory.poses, segment), TrajectoryFormat::kTum,
                       absl::StrCat("segment ", segment, " of ", record.traverse.name));
    status.Update(text.ok() ? WriteFileAtomically(absl::StrCat(folder, "/trajectory_", segment, ".tum"), *text)
                            : text.status());
  }
  if (!record.map.empty()) status.Update(WriteCloudFile(folder + "/map.ply", {record.map, std::nullopt}));
  return status;
}

}  // namespace

absl::StatusOr<std::string> WriteTraverseReport(const TraverseRecord& record, const std::string& folder) {
  if (const absl::Status written = WriteData(record, folder); !written.ok()) return written;
  return WritePage(folder, FigureOptions(), Drawing::kTraverse,
                   {.title = absl::StrCat("Drive ", record.traverse.name),
                    .summary = Summary(record),
                    .details = ScanTable(record)});
}

}  // namespace curvereg::cli
