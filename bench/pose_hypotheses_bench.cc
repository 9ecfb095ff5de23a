// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// From the features of two views to poses, matching included, beside a copy of the points.
#include "core/pose/pose_hypotheses.h"

#include "bench/bench_scene.h"
#include "bench/ratio.h"

int main(int argc, char** argv) {
  const auto target = curvereg::bench::BenchScan(curvereg::bench::BenchPose(0.0, 0.0, 0.0));
  const auto source = curvereg::bench::BenchScan(curvereg::bench::BenchPose(4.0, 2.0, 0.3));
  const Eigen::Matrix3d level = Eigen::Matrix3d::Identity();
  const auto target_view = curvereg::ComputeViewFeatures(target, level, curvereg::ElevationViewOptions());
  const auto source_view = curvereg::ComputeViewFeatures(source, level, curvereg::ElevationViewOptions());
  if (!target_view.ok() || !source_view.ok()) return 1;
  return curvereg::bench::PrintRatios(
      argc, argv, curvereg::bench::CopyOf(target),
      {{"FindPoseHypotheses, elevation",
        [&] { static_cast<void>(curvereg::FindPoseHypotheses(*source_view, *target_view, {})); }}});
}
