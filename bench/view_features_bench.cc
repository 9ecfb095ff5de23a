// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// From points to features beside one FFT there and back of an image of the view's size.
#include "core/features/view_features.h"

#include "bench/bench_scene.h"
#include "bench/ratio.h"

int main(int argc, char** argv) {
  const auto points = curvereg::bench::BenchScan(curvereg::bench::BenchPose(0.0, 0.0, 0.0));
  const Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  const curvereg::ViewOptions elevation = curvereg::ElevationViewOptions();
  const curvereg::ViewOptions occupancy = curvereg::OccupancyViewOptions();
  return curvereg::bench::PrintRatios(
      argc, argv, curvereg::bench::FftRoundTrip(elevation.image.size),
      {{"elevation view", [&] { static_cast<void>(curvereg::ComputeViewFeatures(points, R, elevation)); }},
       {"occupancy view", [&] { static_cast<void>(curvereg::ComputeViewFeatures(points, R, occupancy)); }}});
}
