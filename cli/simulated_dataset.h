// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A simulation as a data set on disk.
#ifndef CURVEREG_CLI_SIMULATED_DATASET_H_
#define CURVEREG_CLI_SIMULATED_DATASET_H_

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "sim/simulation.h"

namespace curvereg::cli {

// Name of scan `index` in the data set, without ending: "0000", "0001", ...
std::string SimulatedScanName(int index);

struct SimulatedDatasetOptions {
  int num_threads = 0;  // most threads to use; 0: one per processor. The bytes do not depend on it
  std::stop_token cancellation;
  std::function<void(int num_done)> progress;  // after each scan; may be empty
};

struct SimulatedDatasetSummary {
  int64_t num_points = 0;    // of all scans
  double mean_step_m = 0.0;  // between consecutive scans; 0 for separate worlds and single scans
  double mean_rotation_rad = 0.0;
};

// Writes NNNN.pcd for each scan and, last, the truth: poses.txt (TUM, sensor to world), or negatives.txt where the
// scans share no ground. Overwrites what an earlier run left. INVALID_ARGUMENT: the folder holds scans or truth that
// this simulation would not overwrite and that a reader would mix up with it; CANCELLED; errors of writing files.
absl::StatusOr<SimulatedDatasetSummary> WriteSimulatedDataset(const sim::Simulation& simulation,
                                                              const std::string& folder,
                                                              const SimulatedDatasetOptions& options);

}  // namespace curvereg::cli

#endif  // CURVEREG_CLI_SIMULATED_DATASET_H_
