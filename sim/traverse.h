// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Where a rover drives and stops to scan.
#ifndef CURVEREG_SIM_TRAVERSE_H_
#define CURVEREG_SIM_TRAVERSE_H_

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "sim/height_grid.h"

namespace curvereg::sim {

enum class TraverseShape {
  kZigzag,  // along the ground's x and back in reverse gear beside its track, weaving; as many legs as it takes
  kLoop,    // round and round the middle on a slowly turning ellipse
};

struct TraverseOptions {
  TraverseShape shape = TraverseShape::kZigzag;
  double step_m = 5.4;           // of driving between scans
  double step_variation = 0.1;   // stops lie up to this share of a step off their place
  double margin_m = 7.0;         // kept from the edge of the ground
  double weave_rad = 0.06;       // zigzag: how far the heading swings to each side
  double weave_length_m = 60.0;  // zigzag: of one full swing
  double loop_radius_m = 5.3;    // loop: mean of the ellipse's semi-axes
};

struct Waypoint {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  // world x, y [m]
  double heading_rad = 0.0;                         // of the rover's x, counter-clockwise from world x
};

// `num_scans` stops on the ground of `grid`. INVALID_ARGUMENT: the ground is too small for the shape.
absl::StatusOr<std::vector<Waypoint>> PlanTraverse(const HeightGrid& grid, const TraverseOptions& options,
                                                   int num_scans, uint64_t key);

}  // namespace curvereg::sim

#endif  // CURVEREG_SIM_TRAVERSE_H_
