// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Pose hypotheses of the matches of two scans beside a copy of one scan's points.
#include "core/pose/consensus.h"

#include "bench/bench_scene.h"
#include "bench/ratio.h"

int main(int argc, char** argv) {
  const curvereg::bench::BenchPair pair;
  const curvereg::ViewFeatures source = curvereg::bench::BenchView(pair.source);
  const curvereg::ViewFeatures target = curvereg::bench::BenchView(pair.target);
  const auto matches = curvereg::MatchMutualNearest(source.features, target.features);
  return curvereg::bench::PrintRatios(
      argc, argv, curvereg::bench::CopyOf(pair.source),
      {{"FindPlanarHypotheses, " + std::to_string(matches.size()) + " matches",
        [&] { static_cast<void>(curvereg::FindPlanarHypotheses(source.planar, target.planar, matches)); }}});
}
