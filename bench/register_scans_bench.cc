// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// End to end: two scans in memory to result, and a scan against a prepared one, beside a copy of one scan's points.
#include "core/register_scans.h"

#include <cstdio>
#include <memory>

#include "bench/bench_scene.h"
#include "bench/ratio.h"
#include "core/parallel.h"

int main(int argc, char** argv) {
  const curvereg::bench::BenchPair pair;
  curvereg::Scan source, target;
  source.points = pair.source;
  target.points = pair.target;
  const auto target_shared = std::make_shared<curvereg::Scan>(target);
  const auto source_shared = std::make_shared<curvereg::Scan>(source);
  const auto prepared_target = *curvereg::PreparedScan::Create(target_shared);
  static_cast<void>(prepared_target->View(curvereg::BirdsEyeView::kElevation, 0));
  bool accepted = true;
  const auto register_both = [&](int num_threads) {
    curvereg::RegistrationOptions options;
    options.num_threads = num_threads;
    accepted = accepted && curvereg::RegisterScans(source, target, options)->verdict.accepted;
  };
  const auto register_next = [&](int num_threads) {
    curvereg::RegistrationOptions options;
    options.num_threads = num_threads;
    std::unique_ptr<const curvereg::PreparedScan> prepared;
    curvereg::WithThreadLimit(num_threads, [&] { prepared = *curvereg::PreparedScan::Create(source_shared); });
    accepted = accepted && curvereg::RegisterPreparedScans(*prepared, *prepared_target, options)->verdict.accepted;
  };
  const int status = curvereg::bench::PrintRatios(
      argc, argv, curvereg::bench::CopyOf(pair.source),
      {{"RegisterScans", register_both}, {"a scan against a prepared one", register_next}});
  if (!accepted) std::printf("not every registration was accepted\n");
  return accepted ? status : 1;
}
