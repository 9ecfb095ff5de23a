// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Band-limited fractal relief: smooth value noise summed over octaves, self-affine as natural ground is.
#ifndef CURVEREG_SIM_FRACTAL_NOISE_H_
#define CURVEREG_SIM_FRACTAL_NOISE_H_

#include <cstdint>

namespace curvereg::sim {

struct FractalOptions {
  double longest_wavelength_m = 40.0;  // of the first octave
  double shortest_wavelength_m = 0.5;  // octaves halve until below it
  double amplitude_m = 1.0;            // of the first octave; values lie in [-amplitude, amplitude] before summing
  double hurst = 0.9;                  // amplitude of an octave ~ wavelength^hurst; natural ground: 0.5 rough, 1 smooth
};

// Height [m] at (x, y) [m]; a pure, twice differentiable function of position and key.
double FractalNoise(double x, double y, const FractalOptions& options, uint64_t key);

// One octave: value noise of lattice spacing 1, in [-1, 1].
double ValueNoise(double x, double y, uint64_t key);

}  // namespace curvereg::sim

#endif  // CURVEREG_SIM_FRACTAL_NOISE_H_
