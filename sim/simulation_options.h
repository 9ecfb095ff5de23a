// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Everything that a simulation is made of. The defaults are the preset `mars-yard-sim`.
#ifndef CURVEREG_SIM_SIMULATION_OPTIONS_H_
#define CURVEREG_SIM_SIMULATION_OPTIONS_H_

#include <cstdint>

#include "absl/status/status.h"
#include "sim/dome_world.h"
#include "sim/elevation_model.h"
#include "sim/rover.h"
#include "sim/scanner.h"
#include "sim/traverse.h"
#include "sim/yard_world.h"

namespace curvereg::sim {

enum class WorldKind { kYard, kDome, kElevationModel };

struct WorldOptions {
  WorldKind kind = WorldKind::kYard;
  double relief = 1.0;       // scales all heights of ground and rocks
  bool clear_drive = false;  // tall rocks are taken out of the rover's way instead of the rover avoiding them
  YardOptions yard = {};
  DomeOptions dome = {};
  ElevationOptions elevation = {};
};

struct SimulationOptions {
  uint64_t seed = 1;  // of world, drive and scanner; the same seed gives the same bytes
  int num_scans = 40;
  WorldOptions world = {};
  TraverseOptions traverse = {};
  RoverOptions rover = {};
  ScannerOptions scanner = {};
  bool random_yaw = false;  // arbitrary heading of the sensor on its mast at each scan
  // Each scan stands in a world of its own, of any kind: yards, nearly flat ones, rough ones, domes. The pairs of
  // Simulation::NegativePairs() do not overlap.
  bool separate_worlds = false;
};

// OK, or INVALID_ARGUMENT that names the first option out of its range.
absl::Status Validate(const SimulationOptions& options);

}  // namespace curvereg::sim

#endif  // CURVEREG_SIM_SIMULATION_OPTIONS_H_
