// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The curvelet transform beside one plain real FFT and its inverse of the image, single thread, double precision.
#include "core/curvelet/curvelet_transform.h"

#include <cmath>
#include <cstdio>
#include <utility>

#include "bench/median_time.h"

namespace {

using curvereg::FftKind;
using curvereg::GetFftPlan;
using curvereg::Image;

void Measure(int rows, int cols) {
  Image<double> image(rows, cols);
  for (std::size_t i = 0; i < image.size(); ++i) image.pixels[i] = std::sin(0.37 * static_cast<double>(i % 9973));
  Image<double> back(rows, cols);
  curvereg::FftBuffer<std::complex<double>> spectrum(static_cast<std::size_t>(rows * (cols / 2 + 1)));
  const auto forward = GetFftPlan<double>({rows, cols}, FftKind::kRealToHalf);
  const auto inverse = GetFftPlan<double>({rows, cols}, FftKind::kHalfToReal);
  const auto transform = curvereg::CurveletTransform::Create(rows, cols);
  const auto curvelets = transform->Forward(image);
  const std::vector<double> seconds =
      curvereg::bench::MedianSeconds(41, {[&] { forward->Execute(image.pixels.data(), spectrum.data()); },
                                          [&] { inverse->Execute(spectrum.data(), back.pixels.data()); },
                                          [&] { static_cast<void>(transform->Forward(image)); },
                                          [&] { static_cast<void>(transform->Inverse(*curvelets)); }});
  const std::vector<double> creation =
      curvereg::bench::MedianSeconds(3, {[&] { static_cast<void>(curvereg::CurveletTransform::Create(rows, cols)); }});
  const double plain = seconds[0] + seconds[1];
  std::printf("%4d x %-4d %2d %8.3f %8.3f %9.3f %9.3f %9.1f %16.2f %16.2f\n", rows, cols,
              transform->options().num_scales, 1e3 * seconds[0], 1e3 * seconds[1], 1e3 * seconds[2], 1e3 * seconds[3],
              1e3 * creation[0], seconds[2] / plain, seconds[3] / plain);
}

}  // namespace

int main() {
  std::printf("curvelet transform, real, 16 angles, finest wavelets, double, one thread; medians [ms]\n");
  std::printf("       size  J      r2c      c2r   forward   inverse    create  ");
  std::printf("forward/(r2c+c2r) inverse/(r2c+c2r)\n");
  for (const auto& [rows, cols] : {std::pair{720, 361}, {256, 256}, {720, 360}, {512, 512}}) Measure(rows, cols);
  return 0;
}
