// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What every scan is asked before the work starts, beside a copy of the points.
#include "core/scan/scan.h"

#include "bench/bench_scene.h"
#include "bench/ratio.h"

int main(int argc, char** argv) {
  const curvereg::Scan scan{curvereg::bench::BenchScan(curvereg::bench::BenchPose(0.0, 0.0, 0.0)), std::nullopt};
  return curvereg::bench::PrintRatios(argc, argv, curvereg::bench::CopyOf(scan.points),
                                      {{"ValidateScan", [&] { static_cast<void>(curvereg::ValidateScan(scan)); }},
                                       {"ScanDigest", [&] { static_cast<void>(curvereg::ScanDigest(scan)); }}});
}
