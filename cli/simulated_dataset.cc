// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulated_dataset.h"

#include <filesystem>
#include <set>
#include <system_error>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/parallel.h"
#include "files/atomic_file.h"
#include "files/cloud_file.h"
#include "files/trajectory_file.h"

namespace curvereg::cli {
namespace {

std::string ScanFile(int index) { return SimulatedScanName(index) + ".pcd"; }

std::string TruthFile(const sim::Simulation& simulation) {
  return simulation.options().separate_worlds ? "negatives.txt" : "poses.txt";
}

// A longer run's scans, or another's truth, would be taken for part of this data set.
absl::Status CheckLeftovers(const sim::Simulation& simulation, const std::string& folder) {
  std::set<std::string> ours = {TruthFile(simulation)};
  for (int i = 0; i < simulation.num_scans(); ++i) ours.insert(ScanFile(i));
  const std::set<std::string> truths = {"poses.txt", "pairs.txt", "negatives.txt", "strangers.txt"};
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (ours.contains(name)) continue;
    if (truths.contains(name) || (HasCloudEnding(name) && !name.starts_with('.'))) {
      return absl::InvalidArgumentError(
          absl::StrCat(folder, ": contains ", name, ", which is not part of this simulation; choose another folder"));
    }
  }
  if (error) return absl::InvalidArgumentError(absl::StrCat(folder, ": cannot be listed: ", error.message()));
  return absl::OkStatus();
}

absl::Status WriteTruth(const sim::Simulation& simulation, const std::string& path) {
  if (simulation.options().separate_worlds) {
    std::string text = "# source target: pairs that share no ground; there is no transform between them\n";
    for (const auto& [source, target] : simulation.NegativePairs()) {
      absl::StrAppend(&text, SimulatedScanName(source), " ", SimulatedScanName(target), "\n");
    }
    return WriteFileAtomically(path, text);
  }
  std::vector<StampedPose> poses;
  for (int i = 0; i < simulation.num_scans(); ++i) {
    poses.push_back({.timestamp_s = static_cast<double>(i), .T_world_scan = simulation.T_world_scan(i)});
  }
  return WriteTrajectoryFile(path, poses);
}

SimulatedDatasetSummary MotionOf(const sim::Simulation& simulation) {
  SimulatedDatasetSummary summary;
  if (simulation.options().separate_worlds || simulation.num_scans() < 2) return summary;
  for (int i = 1; i < simulation.num_scans(); ++i) {
    const TransformDifference step = Difference(simulation.T_world_scan(i - 1), simulation.T_world_scan(i));
    summary.mean_step_m += step.translation_m / (simulation.num_scans() - 1);
    summary.mean_rotation_rad += step.rotation_rad / (simulation.num_scans() - 1);
  }
  return summary;
}

}  // namespace

std::string SimulatedScanName(int index) { return absl::StrFormat("%04d", index); }

absl::StatusOr<SimulatedDatasetSummary> WriteSimulatedDataset(const sim::Simulation& simulation,
                                                              const std::string& folder,
                                                              const SimulatedDatasetOptions& options) {
  if (absl::Status status = CheckLeftovers(simulation, folder); !status.ok()) return status;
  SimulatedDatasetSummary summary = MotionOf(simulation);
  for (int i = 0; i < simulation.num_scans(); ++i) {
    if (options.cancellation.stop_requested()) return absl::CancelledError("interrupted");
    Scan scan;
    WithThreadLimit(options.num_threads, [&] { scan = simulation.ScanAt(i); });
    summary.num_points += static_cast<int64_t>(scan.points.size());
    if (absl::Status status = WriteCloudFile(absl::StrCat(folder, "/", ScanFile(i)), scan); !status.ok()) return status;
    if (options.progress) options.progress(i + 1);
  }
  const absl::Status truth = WriteTruth(simulation, absl::StrCat(folder, "/", TruthFile(simulation)));
  if (!truth.ok()) return truth;
  return summary;
}

}  // namespace curvereg::cli
