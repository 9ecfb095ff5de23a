// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Refinement of a pose on all levels beside a copy of one scan's points.
#include "core/pose/refinement.h"

#include "bench/bench_scene.h"
#include "bench/ratio.h"

int main(int argc, char** argv) {
  const curvereg::bench::BenchPair pair;
  const auto source = curvereg::BuildVoxelMaps(pair.source);
  const auto target = curvereg::BuildVoxelMaps(pair.target);
  curvereg::RigidTransform T_start = pair.T_target_source;
  T_start.pretranslate(Eigen::Vector3d(0.1, -0.1, 0.05));
  const auto refine = [&](curvereg::LevelRange levels, bool measure_information) {
    curvereg::RefinementOptions options;
    options.measure_information = measure_information;
    static_cast<void>(curvereg::RefineOnLevels(source, target, levels, T_start, options, {}));
  };
  return curvereg::bench::PrintRatios(argc, argv, curvereg::bench::CopyOf(pair.source),
                                      {{"RefineOnLevels, all, information",
                                        [&] {
                                          refine({0, 2}, true);
                                        }},
                                       {"RefineOnLevels, all",
                                        [&] {
                                          refine({0, 2}, false);
                                        }},
                                       {"RefineOnLevels, coarsest", [&] {
                                          refine({2, 2}, false);
                                        }}});
}
