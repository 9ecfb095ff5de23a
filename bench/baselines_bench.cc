// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The paper's baselines on a pair of simulated yard scans, thinned by voxels so that this takes seconds, beside plain
// copies of the scans' points, single thread.
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "bench/median_time.h"
#include "core/baselines/fpfh_sac_ia.h"
#include "core/baselines/harris3d_fpfh.h"
#include "sim/presets.h"
#include "sim/simulation.h"

namespace {

using Register = absl::StatusOr<curvereg::BaselineResult> (*)(const curvereg::Scan&, const curvereg::Scan&,
                                                              const curvereg::BaselineOptions&);

void Measure(const std::string& name, Register function, const curvereg::Scan& source, const curvereg::Scan& target) {
  std::vector<Eigen::Vector3f> copy;
  for (const double voxel_size_m : {1.0, 0.5}) {
    curvereg::BaselineOptions options;
    options.voxel_size_m = voxel_size_m;
    curvereg::BaselineResult result;
    const std::vector<double> seconds = curvereg::bench::MedianSeconds(1, {[&] {
                                                                             copy = source.points;
                                                                             copy = target.points;
                                                                           },
                                                                           [&] {
                                                                             auto answer =
                                                                                 function(source, target, options);
                                                                             if (answer.ok())
                                                                               result = *std::move(answer);
                                                                           }});
    std::printf("%-14s %8.1f %11d %8.2f %10.3f %12.0f\n", name.c_str(), voxel_size_m, result.num_source_keypoints,
                seconds[1], 1e3 * seconds[0], seconds[1] / seconds[0]);
  }
}

}  // namespace

int main() {
  auto options = curvereg::sim::PresetOptions("mars-yard-sim");
  if (!options.has_value()) return 1;
  options->num_scans = 2;
  const auto simulation = curvereg::sim::Simulation::Create(*options);
  if (!simulation.ok()) return 1;
  const curvereg::Scan target = simulation->ScanAt(0);
  const curvereg::Scan source = simulation->ScanAt(1);
  std::printf("%zu and %zu points, one thread\n", source.points.size(), target.points.size());
  std::printf("method         voxel m  key points        s    copy ms register/copy\n");
  Measure("fpfh-sac-ia", &curvereg::RegisterFpfhSacIa, source, target);
  Measure("harris3d-fpfh", &curvereg::RegisterHarris3dFpfh, source, target);
  return 0;
}
