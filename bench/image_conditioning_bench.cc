// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Conditioning of an elevation image beside one FFT there and back of an image of its size.
#include "core/views/image_conditioning.h"

#include "bench/bench_scene.h"
#include "bench/ratio.h"
#include "core/views/scan_image.h"

int main(int argc, char** argv) {
  const auto points = curvereg::bench::BenchScan(curvereg::bench::BenchPose(0.0, 0.0, 0.0));
  const curvereg::BirdsEyeImage view = curvereg::ElevationImage(points, Eigen::Matrix3d::Identity());
  curvereg::Image<float> image = view.values;
  // Every line starts with a copy of the image as it was, the first line is that alone.
  const auto on_a_copy = [&](auto stage) {
    return [&, stage] {
      image.pixels = view.values.pixels;
      stage();
    };
  };
  return curvereg::bench::PrintRatios(
      argc, argv, curvereg::bench::FftRoundTrip(image.rows),
      {{"copy of the image", on_a_copy([] {})},
       {"FillHoles", on_a_copy([&] { curvereg::FillHoles(view.valid, image); })},
       {"GaussianBlur3x3", on_a_copy([&] { curvereg::GaussianBlur3x3(0.5, image); })},
       {"Detrend", on_a_copy([&] { curvereg::Detrend(view.valid, image); })},
       {"Apodize", on_a_copy([&] { curvereg::Apodize(16, image); })},
       {"ValidFraction", on_a_copy([&] { static_cast<void>(curvereg::ValidFraction(view.valid, 4)); })}});
}
