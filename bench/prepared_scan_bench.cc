// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// All that is computed of one scan alone beside a copy of its points.
#include "core/methods/prepared_scan.h"

#include "bench/bench_scene.h"
#include "bench/ratio.h"

int main(int argc, char** argv) {
  const auto points = curvereg::bench::BenchScan(curvereg::bench::BenchPose(0.0, 0.0, 0.0));
  return curvereg::bench::PrintRatios(
      argc, argv, curvereg::bench::CopyOf(points),
      {{"PreparedScan::Create", [&] { static_cast<void>(curvereg::bench::BenchPrepared(points)); }},
       {"PreparedScan::Create and one view", [&] {
          static_cast<void>(curvereg::bench::BenchPrepared(points)->View(curvereg::BirdsEyeView::kElevation, 0));
        }}});
}
