// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A Mars yard: gravel, fractal relief, hills, ridges, craters and rocks on a rectangle of ground. Beyond its edge there
// is nothing to hit.
#ifndef CURVEREG_SIM_YARD_WORLD_H_
#define CURVEREG_SIM_YARD_WORLD_H_

#include <cstdint>

#include "sim/fractal_noise.h"
#include "sim/rocks.h"
#include "sim/world.h"

namespace curvereg::sim {

struct YardOptions {
  double length_m = 120.0;  // along x
  double width_m = 60.0;    // along y
  double cell_m = 0.25;
  FractalOptions undulation = {
      .longest_wavelength_m = 40.0, .shortest_wavelength_m = 1.0, .amplitude_m = 0.35, .hurst = 1.1};
  double gravel_m = 0.012;  // standard deviation of each vertex
  int num_hills = 7;
  double max_hill_height_m = 2.0;
  int num_ridges = 4;
  double max_ridge_height_m = 1.2;
  int num_craters = 1;
  double max_crater_radius_m = 8.0;
  RockOptions rocks = {};
};

// `relief` scales all heights, of the ground and of the rocks. The world depends on options, relief and key alone.
World MakeYardWorld(const YardOptions& options, double relief, uint64_t key);

}  // namespace curvereg::sim

#endif  // CURVEREG_SIM_YARD_WORLD_H_
