// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Free space of a scan, made and asked, beside a copy of its points.
#include "core/scan/free_space.h"

#include "bench/bench_scene.h"
#include "bench/ratio.h"

int main(int argc, char** argv) {
  const curvereg::bench::BenchPair pair;
  const curvereg::FreeSpace free_space(pair.target);
  return curvereg::bench::PrintRatios(
      argc, argv, curvereg::bench::CopyOf(pair.source),
      {{"FreeSpace", [&] { static_cast<void>(curvereg::FreeSpace(pair.target)); }},
       {"AskAll, every point of the other",
        [&] { static_cast<void>(curvereg::AskAll(free_space, pair.T_target_source, pair.source)); }}});
}
