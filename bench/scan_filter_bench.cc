// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Removal of isolated returns beside a copy of the points.
#include "core/scan/scan_filter.h"

#include "bench/bench_scene.h"
#include "bench/ratio.h"

int main(int argc, char** argv) {
  const auto points = curvereg::bench::BenchScan(curvereg::bench::BenchPose(0.0, 0.0, 0.0));
  return curvereg::bench::PrintRatios(
      argc, argv, curvereg::bench::CopyOf(points),
      {{"RemoveIsolatedReturns",
        [&] { static_cast<void>(curvereg::RemoveIsolatedReturns(points, Eigen::Vector3d::UnitZ())); }}});
}
