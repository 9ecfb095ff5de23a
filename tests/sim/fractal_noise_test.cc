// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/fractal_noise.h"

#include <gtest/gtest.h>

#include <cmath>

namespace curvereg::sim {
namespace {

TEST(FractalNoiseTest, IsContinuousAndBounded) {
  double largest = 0.0;
  for (int i = 0; i < 20'000; ++i) {
    const double x = 0.013 * i - 130.0;
    const double y = 0.007 * i - 50.0;
    const double here = ValueNoise(x, y, 5);
    largest = std::max(largest, std::abs(here));
    EXPECT_NEAR(ValueNoise(x + 1e-6, y, 5), here, 1e-5);
  }
  EXPECT_LE(largest, 1.0);
  EXPECT_GT(largest, 0.7);
}

TEST(FractalNoiseTest, KeysGiveDifferentGround) {
  EXPECT_EQ(FractalNoise(3.3, 4.4, {}, 1), FractalNoise(3.3, 4.4, {}, 1));
  EXPECT_NE(FractalNoise(3.3, 4.4, {}, 1), FractalNoise(3.3, 4.4, {}, 2));
}

TEST(FractalNoiseTest, AmplitudeScalesAndShortWavelengthsEnd) {
  FractalOptions options = {.amplitude_m = 1.0};
  const double height = FractalNoise(12.3, -7.7, options, 9);
  options.amplitude_m = 0.25;
  EXPECT_NEAR(FractalNoise(12.3, -7.7, options, 9), 0.25 * height, 1e-12);
  // Of 40 m waves alone nothing is left within 10 cm; with octaves down to 20 cm there is.
  options = {.longest_wavelength_m = 40.0, .shortest_wavelength_m = 30.0, .amplitude_m = 1.0, .hurst = 0.5};
  const double smooth = std::abs(FractalNoise(1.1, 1.0, options, 9) - FractalNoise(1.0, 1.0, options, 9));
  EXPECT_LT(smooth, 0.02);
}

}  // namespace
}  // namespace curvereg::sim
