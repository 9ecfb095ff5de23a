// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Matching the features of two scans beside a copy of one scan's points.
#include "core/features/matching.h"

#include "bench/bench_scene.h"
#include "bench/ratio.h"

int main(int argc, char** argv) {
  const curvereg::bench::BenchPair pair;
  const curvereg::Features source = curvereg::bench::BenchView(pair.source).features;
  const curvereg::Features target = curvereg::bench::BenchView(pair.target).features;
  return curvereg::bench::PrintRatios(
      argc, argv, curvereg::bench::CopyOf(pair.source),
      {{"MatchMutualNearest, " + std::to_string(source.size()) + " x " + std::to_string(target.size()),
        [&] { static_cast<void>(curvereg::MatchMutualNearest(source, target)); }}});
}
