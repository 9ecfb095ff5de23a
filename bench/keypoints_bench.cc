// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Key points of an elevation view beside one FFT there and back of an image of its size.
#include "core/features/keypoints.h"

#include "bench/bench_scene.h"
#include "bench/ratio.h"
#include "core/curvelet/scale_bands.h"
#include "core/views/image_conditioning.h"

int main(int argc, char** argv) {
  const auto points = curvereg::bench::BenchScan(curvereg::bench::BenchPose(0.0, 0.0, 0.0));
  const curvereg::ViewFeatures view = curvereg::bench::BenchView(points);
  const auto bands = curvereg::ComputeScaleBands(view.image.values, curvereg::ScaleBandOptions());
  const auto stack = curvereg::DifferenceOfCurvelets(*bands);
  const curvereg::Image<float> share = curvereg::ValidFraction(view.valid, 4);
  return curvereg::bench::PrintRatios(
      argc, argv, curvereg::bench::FftRoundTrip(view.image.values.rows),
      {{"DifferenceOfCurvelets", [&] { static_cast<void>(curvereg::DifferenceOfCurvelets(*bands)); }},
       {"DetectKeypoints", [&] { static_cast<void>(curvereg::DetectKeypoints(stack, share)); }}});
}
