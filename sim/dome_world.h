// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// An indoor Mars dome: a round floor of sand and gravel with a crater basin, a ridge, mounds and rocks under a shell.
#ifndef CURVEREG_SIM_DOME_WORLD_H_
#define CURVEREG_SIM_DOME_WORLD_H_

#include <cstdint>

#include "sim/fractal_noise.h"
#include "sim/rocks.h"
#include "sim/world.h"

namespace curvereg::sim {

struct DomeOptions {
  double diameter_m = 40.0;
  double height_m = 20.0;  // of the shell's top; half the diameter makes a hemisphere
  double cell_m = 0.25;
  FractalOptions undulation = {
      .longest_wavelength_m = 16.0, .shortest_wavelength_m = 1.0, .amplitude_m = 0.15, .hurst = 1.1};
  double gravel_m = 0.01;
  int num_mounds = 5;
  RockOptions rocks = {.density_per_m2 = 0.35, .max_diameter_m = 1.2, .num_boulders = 4};
};

// `relief` scales the heights of floor and rocks, not the shell.
World MakeDomeWorld(const DomeOptions& options, double relief, uint64_t key);

}  // namespace curvereg::sim

#endif  // CURVEREG_SIM_DOME_WORLD_H_
