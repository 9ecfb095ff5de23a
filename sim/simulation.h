// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// START HERE. A rover's traverse through a simulated world: poses at once, each scan when it is asked for.
#ifndef CURVEREG_SIM_SIMULATION_H_
#define CURVEREG_SIM_SIMULATION_H_

#include <memory>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/rigid_transform.h"
#include "core/scan/scan.h"
#include "sim/simulation_options.h"
#include "sim/world.h"

namespace curvereg::sim {

// Immutable; safe to share between threads.
class Simulation {
 public:
  // Builds the world and drives through it. INVALID_ARGUMENT: an option out of range, no place to stand;
  // NOT_FOUND, DATA_LOSS, INVALID_ARGUMENT of ReadEsriAsciiGrid.
  static absl::StatusOr<Simulation> Create(const SimulationOptions& options);

  const SimulationOptions& options() const { return options_; }
  int num_scans() const { return static_cast<int>(T_world_scan_.size()); }

  // True pose of the sensor at scan `index`; a world of its own per scan where options.separate_worlds is set.
  const RigidTransform& T_world_scan(int index) const { return T_world_scan_[static_cast<std::size_t>(index)]; }
  const World& world(int index) const { return *worlds_[static_cast<std::size_t>(index) % worlds_.size()]; }

  // The scan, in parallel over beams (core/base/parallel.h). The same bytes each time and at any thread count.
  Scan ScanAt(int index) const;

  // Pairs (source, target) of scans that share no ground; empty unless options.separate_worlds is set.
  std::vector<std::pair<int, int>> NegativePairs() const;

 private:
  explicit Simulation(const SimulationOptions& options) : options_(options) {}

  SimulationOptions options_;
  std::vector<std::shared_ptr<const World>> worlds_;  // one, or one per scan
  std::vector<RigidTransform> T_world_scan_;
};

}  // namespace curvereg::sim

#endif  // CURVEREG_SIM_SIMULATION_H_
