// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The views from the sensor and the features of the method `paper` beside a copy of the scan's points.
#include "core/views/range_image.h"

#include "bench/bench_scene.h"
#include "bench/ratio.h"
#include "core/features/paper_features.h"
#include "core/views/range_conditioning.h"

int main(int argc, char** argv) {
  const curvereg::Scan scan{curvereg::bench::BenchScan(curvereg::bench::BenchPose(0.0, 0.0, 0.0)), {}};
  const curvereg::RangeImage image = *curvereg::ComputeRangeImage(scan.points);
  const std::string points = std::to_string(scan.points.size()) + " points";
  return curvereg::bench::PrintRatios(
      argc, argv, curvereg::bench::CopyOf(scan.points),
      {{"ComputeRangeImage, " + points, [&] { static_cast<void>(curvereg::ComputeRangeImage(scan.points)); }},
       {"ComputeBearingAngles, 720 x " + std::to_string(image.range.rows),
        [&] { static_cast<void>(curvereg::ComputeBearingAngles(image, scan.points)); }},
       {"ConditionRange, 720 x " + std::to_string(image.range.rows),
        [&] { static_cast<void>(curvereg::ConditionRange(image, 0.5)); }},
       {"ComputePaperFeatures, " + points,
        [&] { static_cast<void>(curvereg::ComputePaperFeatures(scan, {}, curvereg::Stop{})); }}});
}
