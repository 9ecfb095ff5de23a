// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Outlier removal beside a copy of the points.
#include "core/scan/outlier_removal.h"

#include "bench/bench_scene.h"
#include "bench/ratio.h"

int main(int argc, char** argv) {
  const auto points = curvereg::bench::BenchScan(curvereg::bench::BenchPose(0.0, 0.0, 0.0));
  return curvereg::bench::PrintRatios(
      argc, argv, curvereg::bench::CopyOf(points),
      {{"RemoveOutliers", [&] { static_cast<void>(curvereg::RemoveOutliers(points, Eigen::Vector3d::UnitZ())); }}});
}
