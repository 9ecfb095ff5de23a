// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Surfels of a scan beside a copy of its points.
#include "core/scan/voxel_map.h"

#include "bench/bench_scene.h"
#include "bench/ratio.h"

int main(int argc, char** argv) {
  const auto points = curvereg::bench::BenchScan(curvereg::bench::BenchPose(0.0, 0.0, 0.0));
  const curvereg::VoxelMap finest = curvereg::BuildVoxelMaps(points).front();
  int64_t num_found = 0;
  const auto find_all = [&] {
    for (const Eigen::Vector3f& point : points) num_found += finest.Find(point);
  };
  return curvereg::bench::PrintRatios(
      argc, argv, curvereg::bench::CopyOf(points),
      {{"BuildVoxelMaps, 3 levels", [&] { static_cast<void>(curvereg::BuildVoxelMaps(points)); }},
       {"VoxelMap::Find of every point", find_all}});
}
