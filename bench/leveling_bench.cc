// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Candidate verticals from a scan's surfels beside a copy of its points.
#include "core/scan/leveling.h"

#include "bench/bench_scene.h"
#include "bench/ratio.h"

int main(int argc, char** argv) {
  const auto points = curvereg::bench::BenchScan(curvereg::bench::BenchPose(0.0, 0.0, 0.0));
  const auto maps = curvereg::BuildVoxelMaps(points);
  return curvereg::bench::PrintRatios(
      argc, argv, curvereg::bench::CopyOf(points),
      {{"FindVerticals", [&] { static_cast<void>(curvereg::FindVerticals(maps, std::nullopt)); }}});
}
