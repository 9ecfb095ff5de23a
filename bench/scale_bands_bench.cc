// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Six scale bands of an image beside one plain real FFT and six plain inverse ones, single thread, single precision.
#include "core/curvelet/scale_bands.h"

#include <cmath>
#include <cstdio>
#include <utility>

#include "bench/median_time.h"

namespace {

using curvereg::FftKind;
using curvereg::GetFftPlan;
using curvereg::Image;

void Measure(int rows, int cols) {
  Image<float> image(rows, cols);
  for (std::size_t i = 0; i < image.size(); ++i) image.pixels[i] = std::sin(0.37F * static_cast<float>(i % 9973));
  Image<float> back(rows, cols);
  curvereg::FftBuffer<std::complex<float>> spectrum(static_cast<std::size_t>(rows * (cols / 2 + 1)));
  const auto forward = GetFftPlan<float>({rows, cols}, FftKind::kRealToHalf);
  const auto inverse = GetFftPlan<float>({rows, cols}, FftKind::kHalfToReal);
  const curvereg::ScaleBandOptions options;
  const auto bands = curvereg::ScaleBands<float>::Create(rows, cols, options);
  const std::vector<double> seconds =
      curvereg::bench::MedianSeconds(101, {[&] { forward->Execute(image.pixels.data(), spectrum.data()); },
                                           [&] { inverse->Execute(spectrum.data(), back.pixels.data()); },
                                           [&] { static_cast<void>(bands->Compute(image)); },
                                           [&] { static_cast<void>(curvereg::ComputeScaleBands(image, options)); }});
  const double plain = seconds[0] + 6.0 * seconds[1];
  std::printf("%4d x %-4d %9.3f %9.3f %15.3f %13.3f %16.2f %15.2f\n", rows, cols, 1e3 * seconds[0], 1e3 * seconds[1],
              1e3 * seconds[2], 1e3 * seconds[3], seconds[2] / plain, seconds[3] / plain);
}

}  // namespace

int main() {
  std::printf("six polar scale bands, float, one thread; medians [ms]; ratio to (r2c + 6 c2r)\n");
  std::printf("       size       r2c       c2r   plan+tables kept     one-off     ratio (kept) ratio (one-off)\n");
  for (const auto& [rows, cols] : {std::pair{256, 256}, {192, 192}, {720, 361}, {720, 360}}) Measure(rows, cols);
  return 0;
}
