// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/simulation_options.h"

#include <cmath>
#include <string_view>

#include "absl/strings/str_format.h"

namespace curvereg::sim {
namespace {

// Collects the first complaint.
class RangeCheck {
 public:
  void Within(std::string_view name, double value, double low, double high) {
    if (!status_.ok() || (value >= low && value <= high)) return;
    status_ = absl::InvalidArgumentError(absl::StrFormat("%s is %g; it must be from %g to %g", name, value, low, high));
  }
  void Share(std::string_view name, double value) { Within(name, value, 0.0, 1.0); }
  absl::Status status() const { return status_; }

 private:
  absl::Status status_;
};

void CheckWorld(const WorldOptions& world, RangeCheck* check) {
  check->Within("relief", world.relief, 1e-3, 10.0);
  const bool dome = world.kind == WorldKind::kDome;
  const RockOptions& rocks = dome                             ? world.dome.rocks
                             : world.kind == WorldKind::kYard ? world.yard.rocks
                                                              : world.elevation.rocks;
  check->Within("rock density [1/m^2]", rocks.density_per_m2, 0.0, 100.0);
  check->Within("smallest rock [m]", rocks.min_diameter_m, 1e-3, 10.0);
  check->Within("largest rock [m]", rocks.max_diameter_m, rocks.min_diameter_m, 10.0);
  check->Within("boulders", rocks.num_boulders, 0, 1e6);
  check->Within("yard length [m]", world.yard.length_m, 1.0, 1e4);
  check->Within("yard width [m]", world.yard.width_m, 1.0, 1e4);
  check->Within("yard cell [m]", world.yard.cell_m, 0.01, 10.0);
  check->Within("dome diameter [m]", world.dome.diameter_m, 5.0, 1e3);
  check->Within("dome height [m]", world.dome.height_m, 3.0, 1e3);
  check->Within("dome cell [m]", world.dome.cell_m, 0.01, 10.0);
  check->Within("elevation cell [m]", world.elevation.cell_m, 0.01, 100.0);
}

void CheckScanner(const ScannerOptions& scanner, RangeCheck* check) {
  check->Within("columns", scanner.pattern.columns, 1, 100'000);
  check->Within("rows", scanner.pattern.rows, 1, 10'000);
  check->Within("beams of a scan", static_cast<double>(scanner.pattern.columns) * scanner.pattern.rows, 1, 5e7);
  check->Within("lowest elevation [rad]", scanner.pattern.elevation_min_rad, -1.58, 1.58);
  check->Within("highest elevation [rad]", scanner.pattern.elevation_max_rad, scanner.pattern.elevation_min_rad, 1.58);
  check->Within("rosette half angle [rad]", scanner.pattern.rosette_half_angle_rad, 0.0, 1.58);
  check->Within("least range [m]", scanner.min_range_m, 0.0, 1e4);
  check->Within("largest range [m]", scanner.max_range_m, scanner.min_range_m, 1e4);
  check->Within("range noise [m]", scanner.noise_m, 0.0, 10.0);
  check->Within("range noise per metre", scanner.noise_per_m, 0.0, 1.0);
  check->Within("beam jitter [rad]", scanner.beam_jitter_rad, 0.0, 0.1);
  check->Share("grazing cosine", scanner.grazing_cosine);
  check->Share("share of lost returns", scanner.dropout_fraction);
  check->Share("share of outliers", scanner.outlier_fraction);
  check->Share("share of mixed edges", scanner.mixed_edge_fraction);
  check->Share("share of beams kept", scanner.keep_fraction);
  check->Within("duration of a scan [s]", scanner.motion.duration_s, 0.0, 1e4);
  check->Within("speed [m/s]", scanner.motion.forward_mps, -100.0, 100.0);
  check->Within("yaw rate [rad/s]", scanner.motion.yaw_rate_radps, -100.0, 100.0);
}

}  // namespace

absl::Status Validate(const SimulationOptions& options) {
  RangeCheck check;
  check.Within("number of scans", options.num_scans, 1, 100'000);
  check.Within("step [m]", options.traverse.step_m, 0.01, 1e4);
  check.Within("variation of steps", options.traverse.step_variation, 0.0, 0.49);
  check.Within("margin [m]", options.traverse.margin_m, 1.0, 1e4);
  check.Within("weave [rad]", options.traverse.weave_rad, 0.0, 1.0);
  check.Within("weave length [m]", options.traverse.weave_length_m, 1.0, 1e6);
  check.Within("loop radius [m]", options.traverse.loop_radius_m, 0.1, 1e4);
  check.Within("wheelbase [m]", options.rover.wheelbase_m, 0.05, 10.0);
  check.Within("track [m]", options.rover.track_m, 0.05, 10.0);
  check.Within("mast [m]", options.rover.mast_m, 0.1, 100.0);
  CheckWorld(options.world, &check);
  CheckScanner(options.scanner, &check);
  return check.status();
}

}  // namespace curvereg::sim
