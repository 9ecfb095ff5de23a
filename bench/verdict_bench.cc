// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What the verdict asks of a pose beside a copy of one scan's points.
#include "core/methods/verdict.h"

#include "bench/bench_scene.h"
#include "bench/ratio.h"

int main(int argc, char** argv) {
  const curvereg::bench::BenchPair pair;
  const auto source = curvereg::bench::BenchPrepared(pair.source);
  const auto target = curvereg::bench::BenchPrepared(pair.target);
  const curvereg::ViewFeatures& source_view = **source->View(curvereg::BirdsEyeView::kElevation, 0);
  const curvereg::ViewFeatures& target_view = **target->View(curvereg::BirdsEyeView::kElevation, 0);
  const curvereg::RigidTransform& T = pair.T_target_source;
  const auto fit = curvereg::RefineOnLevels(source->voxel_maps(), target->voxel_maps(), {0, 2}, T, {}, {});
  return curvereg::bench::PrintRatios(
      argc, argv, curvereg::bench::CopyOf(pair.source),
      {{"CheckPose", [&] { static_cast<void>(curvereg::CheckPose(*source, *target, T)); }},
       {"CorrelateViews", [&] { static_cast<void>(curvereg::CorrelateViews(source_view, target_view, T)); }},
       {"FindDegenerateDirections", [&] { static_cast<void>(curvereg::FindDegenerateDirections(fit, 5.0)); }}});
}
