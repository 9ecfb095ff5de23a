// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/presets.h"

#include <array>

namespace curvereg::sim {
namespace {

constexpr std::array<Preset, 9> kPresets = {{
    {"mars-yard-sim", "40 scans of 224k points, 5.4 m apart, in a Mars yard of 60 m x 120 m (paper, section 5)"},
    {"mars-yard-real", "17 scans of a million beams thinned to a quarter, 15 m apart, with bad returns (paper)"},
    {"mars-dome", "95 scans in an indoor dome of 40 m; every fifth pair is 2.38 m and 0.45 rad apart (paper)"},
    {"random-yaw", "mars-yard-sim with an arbitrary heading at each scan"},
    {"sparse", "mars-yard-sim with a quarter of the points"},
    {"outliers", "sparse with 15 % of the ranges wrong"},
    {"flat", "mars-yard-sim with all heights scaled by 0.1"},
    {"gale", "30 scans, 8 m apart, on an elevation model from a file, e.g. HiRISE of Gale crater"},
    {"negatives", "40 scans of 40 worlds; 200 pairs that do not overlap and must not be accepted"},
}};

constexpr double kDegree = 0.017453292519943295;

SimulationOptions MarsYardReal() {
  SimulationOptions options;
  options.num_scans = 17;
  options.traverse.step_m = 15.0;
  options.traverse.weave_rad = 0.3;
  // A million beams in 40 s at 25 kHz, one continuous sweep.
  options.scanner.pattern.kind = PatternKind::kSpiral;
  options.scanner.pattern.columns = 2800;
  options.scanner.pattern.rows = 357;
  options.scanner.keep_fraction = 0.25;
  options.scanner.noise_m = 0.02;
  options.scanner.noise_per_m = 0.0003;
  options.scanner.beam_jitter_rad = 0.0003;
  options.scanner.grazing_cosine = 0.04;
  options.scanner.dropout_fraction = 0.03;
  options.scanner.outlier_fraction = 0.01;
  options.scanner.mixed_edge_fraction = 0.3;
  return options;
}

SimulationOptions MarsDome() {
  SimulationOptions options;
  options.num_scans = 95;
  options.world.kind = WorldKind::kDome;
  options.world.clear_drive = true;
  options.traverse.shape = TraverseShape::kLoop;
  options.traverse.step_m = 0.48;
  options.traverse.loop_radius_m = 5.75;
  options.rover.max_tilt_rad = 0.4;
  // A panning and nodding scanner: half-degree steps of elevation, no gap below but the rover's own place.
  options.scanner.pattern.columns = 1440;
  options.scanner.pattern.rows = 138;
  options.scanner.pattern.elevation_min_rad = -58.0 * kDegree;
  options.scanner.pattern.elevation_max_rad = 10.5 * kDegree;
  return options;
}

SimulationOptions Gale() {
  SimulationOptions options;
  options.num_scans = 30;
  options.world.kind = WorldKind::kElevationModel;
  options.traverse.shape = TraverseShape::kLoop;
  options.traverse.step_m = 8.0;
  options.traverse.loop_radius_m = 60.0;
  options.rover.max_tilt_rad = 0.3;
  return options;
}

}  // namespace

std::span<const Preset> Presets() { return kPresets; }

std::optional<SimulationOptions> PresetOptions(std::string_view name) {
  SimulationOptions options;
  if (name == "mars-yard-sim") return options;
  if (name == "mars-yard-real") return MarsYardReal();
  if (name == "mars-dome") return MarsDome();
  if (name == "gale") return Gale();
  if (name == "random-yaw") {
    options.random_yaw = true;
    return options;
  }
  if (name == "sparse" || name == "outliers") {
    options.scanner.keep_fraction = 0.25;
    if (name == "sparse") return options;
    options.scanner.outlier_fraction = 0.15;
    options.scanner.mixed_edge_fraction = 0.1;
    return options;
  }
  if (name == "flat") {
    options.world.relief = 0.1;
    return options;
  }
  if (name == "negatives" || name == "strangers") {
    options.separate_worlds = true;
    return options;
  }
  return std::nullopt;
}

}  // namespace curvereg::sim
