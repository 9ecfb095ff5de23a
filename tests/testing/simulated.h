// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Full-size scans of the simulator's presets. Needs curvereg::sim.
#ifndef CURVEREG_TESTS_TESTING_SIMULATED_H_
#define CURVEREG_TESTS_TESTING_SIMULATED_H_

#include <algorithm>
#include <string_view>

#include "sim/presets.h"
#include "sim/simulation.h"

namespace curvereg::testing {

struct ScanPairWithTruth {
  Scan source;
  Scan target;
  RigidTransform T_target_source;
};

// Scans `source` and `target` of a preset; there is none for negative pairs.
// Precondition: `preset` is one of sim::Presets().
inline ScanPairWithTruth PairOf(std::string_view preset, int source, int target) {
  sim::SimulationOptions options = *sim::PresetOptions(preset);
  options.num_scans = std::max(source, target) + 1;  // omits the worlds of later scans
  const sim::Simulation simulation = *sim::Simulation::Create(options);
  return {simulation.ScanAt(source), simulation.ScanAt(target),
          simulation.T_world_scan(target).inverse() * simulation.T_world_scan(source)};
}

// The scan's points over and over, each time moved a little, until there are `num_points`.
inline Scan Multiplied(const Scan& scan, size_t num_points) {
  Scan many;
  many.points.reserve(num_points);
  for (size_t i = 0; i < num_points; ++i) {
    const float shift = 1e-3F * static_cast<float>(i / scan.points.size());
    many.points.push_back(scan.points[i % scan.points.size()] + Eigen::Vector3f(shift, -shift, 0.0F));
  }
  return many;
}

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_TESTING_SIMULATED_H_
