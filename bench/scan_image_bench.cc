// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Views of a scan beside a copy of its points.
#include "core/views/scan_image.h"

#include "bench/bench_scene.h"
#include "bench/ratio.h"

int main(int argc, char** argv) {
  const auto points = curvereg::bench::BenchScan(curvereg::bench::BenchPose(0.0, 0.0, 0.0));
  const Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  const curvereg::BirdsEyeOptions occupancy{.cell_m = 0.4};
  const curvereg::OccupancySlices slices = curvereg::ComputeOccupancySlices(points, R, occupancy);
  return curvereg::bench::PrintRatios(
      argc, argv, curvereg::bench::CopyOf(points),
      {{"ElevationImage", [&] { static_cast<void>(curvereg::ElevationImage(points, R)); }},
       {"ComputeOccupancySlices", [&] { static_cast<void>(curvereg::ComputeOccupancySlices(points, R, occupancy)); }},
       {"OccupancyImage", [&] { static_cast<void>(curvereg::OccupancyImage(slices)); }}});
}
