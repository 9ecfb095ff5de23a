// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/traverse.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/strings/str_format.h"
#include "sim/random.h"

namespace curvereg::sim {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

// The size of the ground that the rover may use.
Eigen::Vector2d UsableSize(const HeightGrid& grid, const TraverseOptions& options) {
  return {grid.x_max() - grid.x_min - 2.0 * options.margin_m, grid.y_max() - grid.y_min - 2.0 * options.margin_m};
}

// Position along the drive in steps, off the regular place by a random part of a step.
double StopAt(int index, const TraverseOptions& options, uint64_t key) {
  RandomStream random(SubKey(key, static_cast<uint64_t>(index)));
  return index + options.step_variation * random.Uniform(-1.0, 1.0);
}

std::vector<Waypoint> Zigzag(const Eigen::Vector2d& usable, const TraverseOptions& options, int num_scans,
                             uint64_t key) {
  const int num_steps = std::max(1, num_scans - 1);
  const int most_steps_of_leg = std::max(1, static_cast<int>(usable.x() / options.step_m));
  const int num_legs = (num_steps + most_steps_of_leg - 1) / most_steps_of_leg;
  const int steps_of_leg = (num_steps + num_legs - 1) / num_legs;
  // What weaving adds to the way: half the mean square of the slope.
  const double stretch = 1.0 + 0.25 * options.weave_rad * options.weave_rad;
  const double step_m = options.step_m / stretch;
  const double leg_m = steps_of_leg * step_m;
  const double weave_m = options.weave_rad * options.weave_length_m / kTurn;
  const double shift_m = std::min(0.1 * leg_m, std::max(0.0, usable.y() - 2.0 * weave_m) / num_legs);
  std::vector<Waypoint> stops;
  for (int i = 0; i < num_scans; ++i) {
    const int leg = std::min(i / steps_of_leg, num_legs - 1);
    const bool at_turn = i % steps_of_leg == 0;
    const double along = (at_turn ? i : StopAt(i, options, key)) * step_m - leg * leg_m;
    const bool reverse = leg % 2 == 1;
    const double x = reverse ? 0.5 * leg_m - along : along - 0.5 * leg_m;
    const double phase = kTurn * (along + leg * leg_m) / options.weave_length_m;
    const double y = shift_m * (leg + along / leg_m - 0.5 * num_legs) + weave_m * std::sin(phase);
    // Driving in reverse gear, the rover looks back along its motion: x falls while it looks ahead along +x.
    const double slope = shift_m / leg_m + options.weave_rad * std::cos(phase);
    stops.push_back({.place = {x, y}, .heading_rad = std::atan(reverse ? -slope : slope)});
  }
  return stops;
}

Eigen::Vector2d LoopPlace(const TraverseOptions& options, double angle) {
  constexpr double kFlattening = 0.06;
  constexpr double kPrecession = 0.13;  // so that no lap repeats the last one
  const Eigen::Vector2d on_ellipse = options.loop_radius_m * Eigen::Vector2d((1.0 + kFlattening) * std::cos(angle),
                                                                             (1.0 - kFlattening) * std::sin(angle));
  return Eigen::Rotation2Dd(kPrecession * angle) * on_ellipse;
}

std::vector<Waypoint> Loop(const TraverseOptions& options, int num_scans, uint64_t key) {
  const double fine_step = 1e-3;  // rad; chords of it are the length driven to 1e-7
  double angle = RandomStream(SubKey(key, ~uint64_t{0})).Uniform(0.0, kTurn);
  double driven = 0.0;
  Eigen::Vector2d place = LoopPlace(options, angle);
  std::vector<Waypoint> stops;
  for (int i = 0; i < num_scans; ++i) {
    const double target = (i == 0 ? 0.0 : StopAt(i, options, key)) * options.step_m;
    Eigen::Vector2d ahead = LoopPlace(options, angle + fine_step);
    while (driven < target) {
      driven += (ahead - place).norm();
      angle += fine_step;
      place = ahead;
      ahead = LoopPlace(options, angle + fine_step);
    }
    const Eigen::Vector2d motion = ahead - place;
    stops.push_back({.place = place, .heading_rad = std::atan2(motion.y(), motion.x())});
  }
  return stops;
}

}  // namespace

absl::StatusOr<std::vector<Waypoint>> PlanTraverse(const HeightGrid& grid, const TraverseOptions& options,
                                                   int num_scans, uint64_t key) {
  const Eigen::Vector2d usable = UsableSize(grid, options);
  const double needed = options.shape == TraverseShape::kLoop ? 2.2 * options.loop_radius_m : options.step_m;
  const double least = options.shape == TraverseShape::kLoop ? usable.minCoeff() : usable.x();
  if (usable.minCoeff() <= 0.0 || least < needed) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "the ground leaves %.1f m x %.1f m to drive on; the traverse needs %.1f m", usable.x(), usable.y(), needed));
  }
  return options.shape == TraverseShape::kLoop ? Loop(options, num_scans, key)
                                               : Zigzag(usable, options, num_scans, key);
}

}  // namespace curvereg::sim
