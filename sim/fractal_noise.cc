// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/fractal_noise.h"

#include <cmath>

#include "sim/random.h"

namespace curvereg::sim {
namespace {

double LatticeValue(int64_t ix, int64_t iy, uint64_t key) {
  const uint64_t bits = SubKey(SubKey(key, static_cast<uint64_t>(ix)), static_cast<uint64_t>(iy));
  return static_cast<double>(bits >> 11) * 0x1.0p-52 - 1.0;
}

double Fade(double t) { return t * t * t * (t * (6.0 * t - 15.0) + 10.0); }

}  // namespace

double ValueNoise(double x, double y, uint64_t key) {
  const double floor_x = std::floor(x);
  const double floor_y = std::floor(y);
  const auto ix = static_cast<int64_t>(floor_x);
  const auto iy = static_cast<int64_t>(floor_y);
  const double u = Fade(x - floor_x);
  const double v = Fade(y - floor_y);
  const double low = std::lerp(LatticeValue(ix, iy, key), LatticeValue(ix + 1, iy, key), u);
  const double high = std::lerp(LatticeValue(ix, iy + 1, key), LatticeValue(ix + 1, iy + 1, key), u);
  return std::lerp(low, high, v);
}

double FractalNoise(double x, double y, const FractalOptions& options, uint64_t key) {
  // The lattice of a value noise shows as an axis-parallel pattern; turning each octave hides it.
  constexpr double kTurnCos = 0.8;
  constexpr double kTurnSin = 0.6;
  const double gain = std::pow(0.5, options.hurst);
  double height = 0.0;
  double amplitude = options.amplitude_m;
  double spacing = 0.5 * options.longest_wavelength_m;
  for (uint64_t octave = 0; 2.0 * spacing >= options.shortest_wavelength_m; ++octave) {
    height += amplitude * ValueNoise(x / spacing, y / spacing, SubKey(key, octave));
    const double turned = kTurnCos * x - kTurnSin * y;
    y = kTurnSin * x + kTurnCos * y;
    x = turned;
    amplitude *= gain;
    spacing *= 0.5;
  }
  return height;
}

}  // namespace curvereg::sim
