// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/report.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/methods/registration_names.h"
#include "eval/distribution.h"
#include "eval/report_files.h"
#include "eval/report_html.h"
#include "eval/report_json.h"
#include "eval/report_pictures.h"
#include "eval/scan_placement.h"
#include "files/atomic_file.h"

namespace curvereg {
namespace {

std::string DistributionRows(const MethodEvaluation& run) {
  std::vector<double> translations, rotations, seconds;
  for (const PairOutcome& outcome : run.outcomes) {
    if (!outcome.true_T_target_source) continue;
    const TransformDifference error = PoseError(outcome);
    translations.push_back(error.translation_m);
    rotations.push_back(error.rotation_rad);
    seconds.push_back(outcome.seconds);
  }
  std::string rows;
  const auto append = [&](const std::string& quantity, const std::vector<double>& values) {
    for (const DistributionStep& step : EmpiricalDistribution(values, run.summary.pairs)) {
      absl::StrAppendFormat(&rows, "%s,%s,%.17g,%.17g\n", std::string(MethodName(run.method)), quantity, step.value,
                            step.share);
    }
  };
  append("translation_m", translations);
  append("rotation_rad", rotations);
  append("seconds", seconds);
  return rows;
}

bool AnyPose(const std::vector<std::optional<RigidTransform>>& poses) {
  return std::any_of(poses.begin(), poses.end(), [](const auto& T) { return T.has_value(); });
}

std::map<std::string, int> IndexByName(const Dataset& dataset) {
  std::map<std::string, int> index_of;
  for (std::size_t i = 0; i < dataset.scan_names.size(); ++i) index_of[dataset.scan_names[i]] = static_cast<int>(i);
  return index_of;
}

// Where the truth puts the scans: poses.txt, else the true transforms of the pairs chained.
std::vector<std::optional<RigidTransform>> TruePoses(const Dataset& dataset) {
  if (AnyPose(dataset.T_world_scan)) return dataset.T_world_scan;
  std::map<std::string, int> index_of = IndexByName(dataset);
  std::vector<RelativePose> edges;
  for (const ScanPair& pair : dataset.pairs) {
    edges.push_back({index_of[pair.source], index_of[pair.target], pair.T_target_source});
  }
  return PlaceScans(static_cast<int>(dataset.scan_names.size()), edges, {}).T_world_scan;
}

// Where the accepted answers put the scans; each chain starts at a true pose.
std::vector<std::optional<RigidTransform>> EstimatedPoses(
    const MethodEvaluation& run, const Dataset& dataset,
    const std::vector<std::optional<RigidTransform>>& true_T_world_scan) {
  std::map<std::string, int> index_of = IndexByName(dataset);
  std::vector<RelativePose> edges;
  for (const PairOutcome& outcome : run.outcomes) {
    if (!outcome.result.T_target_source || !outcome.result.verdict.accepted) continue;
    edges.push_back({index_of[outcome.source], index_of[outcome.target], *outcome.result.T_target_source});
  }
  return PlaceScans(static_cast<int>(dataset.scan_names.size()), edges, true_T_world_scan).T_world_scan;
}

absl::Status WriteMethodFiles(const MethodEvaluation& run, const Dataset& dataset,
                              const std::vector<std::optional<RigidTransform>>& true_T_world_scan,
                              const std::string& folder, const ReportOptions& options) {
  const auto T_world_scan = EstimatedPoses(run, dataset, true_T_world_scan);
  const std::string name(MethodName(run.method));
  const absl::Status status = WriteScanPoses(absl::StrCat(folder, "/trajectory_", name, ".tum"), T_world_scan);
  if (!status.ok()) return status;
  const std::string map_path = absl::StrCat(folder, "/map_", name, ".ply");
  std::error_code error;
  std::filesystem::remove(map_path, error);  // of an earlier run: without an accepted answer there is no map
  return AnyPose(T_world_scan) ? WriteMergedMap(map_path, dataset, T_world_scan, options) : absl::OkStatus();
}

absl::Status WriteData(const Evaluation& evaluation, const Dataset& dataset, const std::string& folder,
                       const ReportOptions& options) {
  std::string distributions = "method,quantity,value,share\n";
  for (const MethodEvaluation& run : evaluation.methods) distributions += DistributionRows(run);
  const auto true_T_world_scan = TruePoses(dataset);

  absl::Status status = WriteFileAtomically(folder + "/report.json", EvaluationJson(evaluation, 1) + "\n");
  status.Update(WriteFileAtomically(folder + "/distributions.csv", distributions));
  status.Update(WriteScanPoses(folder + "/trajectory_truth.tum", true_T_world_scan));
  for (const MethodEvaluation& run : evaluation.methods) {
    if (status.ok()) status = WriteMethodFiles(run, dataset, true_T_world_scan, folder, options);
  }
  return status;
}

}  // namespace

absl::StatusOr<std::string> WriteReport(const Evaluation& evaluation, const Dataset& dataset, const std::string& folder,
                                        const ReportOptions& options) {
  const absl::Status written = WriteData(evaluation, dataset, folder, options);
  if (!written.ok()) return written;

  return WritePage(folder, options.figures, Drawing::kPairEvaluation, EvaluationPage(evaluation));
}

}  // namespace curvereg
