// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// End to end on scans of the preset mars-yard-sim: two scans in memory to result, and the next scan
// against a prepared one, in turn over the drive's consecutive pairs, beside a copy of one scan's points.
// CURVEREG_BENCH_COLUMNS and CURVEREG_BENCH_ROWS set the beams: 1440 x 800 gives a million points.
#include "core/register_scans.h"

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include "bench/ratio.h"
#include "core/base/parallel.h"
#include "sim/presets.h"
#include "sim/simulation.h"

namespace curvereg {
namespace {

constexpr int kNumScans = 8;

std::vector<std::shared_ptr<const Scan>> DriveScans() {
  sim::SimulationOptions options = *sim::PresetOptions("mars-yard-sim");
  if (const char* columns = std::getenv("CURVEREG_BENCH_COLUMNS")) options.scanner.pattern.columns = std::atoi(columns);
  if (const char* rows = std::getenv("CURVEREG_BENCH_ROWS")) options.scanner.pattern.rows = std::atoi(rows);
  const auto simulation = sim::Simulation::Create(options);
  std::vector<std::shared_ptr<const Scan>> scans;
  for (int i = 0; i < kNumScans; ++i) scans.push_back(std::make_shared<Scan>(simulation->ScanAt(i)));
  return scans;
}

int Main(int argc, char** argv) {
  const std::vector<std::shared_ptr<const Scan>> scans = DriveScans();
  std::printf("scans of %zu points\n", scans.front()->points.size());
  std::vector<std::unique_ptr<const PreparedScan>> prepared;
  for (const auto& scan : scans) {
    prepared.push_back(*PreparedScan::Create(scan));
    static_cast<void>(prepared.back()->View(BirdsEyeView::kElevation, 0));
  }
  bool accepted = true;
  size_t round = 0;
  const auto next_pair = [&round] { return 1 + round++ % (kNumScans - 1); };
  const auto register_both = [&](int num_threads) {
    RegistrationOptions options;
    options.num_threads = num_threads;
    const size_t i = next_pair();
    accepted = accepted && RegisterScans(*scans[i], *scans[i - 1], options)->verdict.accepted;
  };
  const auto register_next = [&](int num_threads) {
    RegistrationOptions options;
    options.num_threads = num_threads;
    const size_t i = next_pair();
    std::unique_ptr<const PreparedScan> next;
    WithThreadLimit(num_threads, [&] { next = *PreparedScan::Create(scans[i]); });
    accepted = accepted && RegisterPreparedScans(*next, *prepared[i - 1], options)->verdict.accepted;
  };
  const int status =
      bench::PrintRatios(argc, argv, bench::CopyOf(scans.front()->points),
                         {{"RegisterScans", register_both}, {"a scan against a prepared one", register_next}});
  if (!accepted) std::printf("not every registration was accepted\n");
  return accepted ? status : 1;
}

}  // namespace
}  // namespace curvereg

int main(int argc, char** argv) { return curvereg::Main(argc, argv); }
