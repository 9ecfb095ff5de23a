// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Maps of 10 scans of 224 000 points, 1 m apart, beside a copy of one scan's points: times are for all 10.
#include "core/mapping/point_map.h"

#include <cstdio>
#include <cstdlib>
#include <memory>

#include "bench/bench_scene.h"
#include "bench/ratio.h"
#include "core/mapping/elevation_map.h"

namespace curvereg::bench {
namespace {

constexpr int kNumScans = 10;

MapInput BenchInput() {
  MapInput input;
  std::vector<std::shared_ptr<const Scan>> scans;
  for (int i = 0; i < kNumScans; ++i) {
    input.T_map_scan.push_back(BenchPose(1.0 * i, 0.2 * i, 0.1 * i));
    scans.push_back(std::make_shared<const Scan>(Scan{.points = BenchScan(input.T_map_scan.back()), .gravity = {}}));
  }
  input.load = [scans](std::size_t index, const Stop&) -> absl::StatusOr<std::shared_ptr<const Scan>> {
    return scans[index];
  };
  return input;
}

void Require(const absl::Status& status) {
  if (status.ok()) return;
  std::fprintf(stderr, "%s\n", std::string(status.message()).c_str());
  std::exit(1);
}

// Points given.
std::size_t Build(const MapInput& input, const PointMapOptions& options) {
  std::size_t num_points = 0;
  Require(BuildPointMap(input, options, [&](std::span<const Eigen::Vector3f> points) {
    num_points += points.size();
    return absl::OkStatus();
  }));
  return num_points;
}

}  // namespace
}  // namespace curvereg::bench

int main(int argc, char** argv) {
  using curvereg::bench::Build;
  const curvereg::MapInput input = curvereg::bench::BenchInput();
  const auto first = *input.load(0, {});
  std::printf("%zu points of 10 scans in cells of 0.1 m, %zu with remove_dynamic\n", Build(input, {}),
              Build(input, {.remove_dynamic = true}));
  return curvereg::bench::PrintRatios(
      argc, argv, curvereg::bench::CopyOf(first->points),
      {{"BuildPointMap, 10 scans, 0.1 m", [&] { Build(input, {}); }},
       {"the same in 4 MB", [&] { Build(input, {.max_memory_bytes = std::size_t{4} << 20}); }},
       {"BuildPointMap, 10 scans, 0.5 m", [&] { Build(input, {.cell_m = 0.5}); }},
       {"with remove_dynamic, 0.1 m", [&] { Build(input, {.remove_dynamic = true}); }},
       {"BuildElevationMap, 0.1 m",
        [&] { curvereg::bench::Require(curvereg::BuildElevationMap(input, {}).status()); }}});
}
