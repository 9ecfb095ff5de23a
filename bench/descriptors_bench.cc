// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Descriptors of the key points of an elevation view beside one FFT there and back of an image of its size.
#include "core/features/descriptors.h"

#include "bench/bench_scene.h"
#include "bench/ratio.h"
#include "core/curvelet/scale_bands.h"
#include "core/views/image_conditioning.h"

int main(int argc, char** argv) {
  const auto points = curvereg::bench::BenchScan(curvereg::bench::BenchPose(0.0, 0.0, 0.0));
  const curvereg::ViewFeatures view = curvereg::bench::BenchView(points);
  const auto bands = curvereg::ComputeScaleBands(view.image.values, curvereg::ScaleBandOptions());
  const auto keypoints =
      curvereg::DetectKeypoints(curvereg::DifferenceOfCurvelets(*bands), curvereg::ValidFraction(view.valid, 4));
  return curvereg::bench::PrintRatios(argc, argv, curvereg::bench::FftRoundTrip(view.image.values.rows),
                                      {{"DescribeKeypoints, " + std::to_string(keypoints.size()) + " key points",
                                        [&] { static_cast<void>(curvereg::DescribeKeypoints(*bands, keypoints)); }}});
}
