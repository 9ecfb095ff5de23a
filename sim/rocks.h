// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Rocks as true bodies: ellipsoids half sunk into the ground, their sizes after a power law as counted on Mars.
#ifndef CURVEREG_SIM_ROCKS_H_
#define CURVEREG_SIM_ROCKS_H_

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "sim/height_grid.h"

namespace curvereg::sim {

// The ellipsoid |to_unit * (p - centre)| = 1.
struct Rock {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Matrix3d to_unit = Eigen::Matrix3d::Identity();
  Eigen::Vector3d half_extent = Eigen::Vector3d::Ones();  // of the bounding box along x, y and z

  // Smallest t >= 0 at which the ray enters the rock; infinity if it does not (also from inside).
  double Intersect(const Ray& ray) const;
  // Outward unit normal at a point of the surface.
  Eigen::Vector3d NormalAt(const Eigen::Vector3d& point) const;
};

struct RockOptions {
  double density_per_m2 = 0.25;  // rocks larger than min_diameter_m per square metre
  double min_diameter_m = 0.1;   // smaller ones are gravel, part of the ground's roughness
  double max_diameter_m = 1.5;
  double exponent = 2.0;  // the share of rocks wider than D falls as D^-exponent
  int num_boulders = 6;   // rocks of boulder size beside them
  double boulder_min_diameter_m = 1.2;
  double boulder_max_diameter_m = 2.5;
};

// Rocks on the ground of `grid`, none in holes. `relief` scales their heights.
std::vector<Rock> ScatterRocks(const HeightGrid& grid, const RockOptions& options, double relief, uint64_t key);

}  // namespace curvereg::sim

#endif  // CURVEREG_SIM_ROCKS_H_
