// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The promised figures on the project's own simulated sets: whole sets, every failure counted.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sim/presets.h"
#include "sim/simulation.h"
#include "tests/testing/evaluation.h"
#include "tests/testing/matchers.h"

namespace curvereg {
namespace {

using testing::IsOk;
using testing::Prepared;

constexpr int kNumThreads = 2;
constexpr double kAnyRotation = 0.1;  // [rad] nothing promised beyond "ok"

// What is promised for the pairs (i + every, i) of a set.
struct Promise {
  int every = 1;
  int max_failures = 0;     // pairs that need not be ok
  double max_rmse_m = 0.0;  // over all pairs; over the ok ones where failures are allowed or `over_ok` says so
  double max_rmse_rad = kAnyRotation;
  bool over_ok = false;
};

struct SetPromise {
  std::string preset;
  std::vector<Promise> promises;
};

std::vector<SetPromise> Promises() {
  constexpr double kFine = 0.0002;
  return {{"mars-yard-sim", {{1, 0, 0.003, kFine}, {2, 0, 0.003, kFine}, {3, 0, 0.004, kFine}, {4, 0, 0.006, kFine}}},
          {"random-yaw", {{1, 0, 0.006}, {2, 0, 0.006}, {3, 0, 0.006}, {4, 0, 0.006}}},
          {"sparse",
           {{1, 0, 0.012, kAnyRotation, true},
            {2, 0, 0.012, kAnyRotation, true},
            {3, 0, 0.012, kAnyRotation, true},
            {4, 2, 0.012, kAnyRotation, true}}},
          {"outliers",
           {{1, 0, 0.03, kAnyRotation, true},
            {2, 0, 0.03, kAnyRotation, true},
            {3, 2, 0.5, kAnyRotation, true},
            {4, 6, 0.5, kAnyRotation, true}}},
          {"flat", {{1, 0, 0.02}, {2, 0, 0.02}}},
          {"mars-dome", {{1, 0, 0.002, kFine}, {5, 0, 0.002, kFine}}}};
}

absl::StatusOr<sim::Simulation> Simulated(const std::string& preset) {
  const std::optional<sim::SimulationOptions> options = sim::PresetOptions(preset);
  if (!options.has_value()) return absl::NotFoundError("no preset " + preset);
  return sim::Simulation::Create(*options);
}

std::vector<Prepared> PreparedScans(const sim::Simulation& simulation) {
  std::vector<Prepared> scans;
  for (int i = 0; i < simulation.num_scans(); ++i) {
    Scan scan;
    WithThreadLimit(kNumThreads, [&] { scan = simulation.ScanAt(i); });
    scans.push_back(testing::PrepareScan(std::move(scan), kNumThreads));
  }
  return scans;
}

PairOutcome Register(const std::vector<Prepared>& scans, int source, int target,
                     const std::optional<RigidTransform>& truth) {
  RegistrationOptions options;
  options.num_threads = kNumThreads;
  PairOutcome outcome =
      testing::RegisterPair(scans[static_cast<size_t>(source)], scans[static_cast<size_t>(target)], truth, options);
  outcome.source = std::to_string(source);
  outcome.target = std::to_string(target);
  return outcome;
}

void ExpectKept(const Promise& promise, const MethodSummary& summary) {
  EXPECT_GE(summary.ok, summary.pairs - promise.max_failures);
  EXPECT_EQ(summary.accepted_wrong, 0);
  EXPECT_EQ(summary.failed_calls, 0);
  EXPECT_LE(promise.over_ok ? summary.rmse_ok_translation_m : summary.rmse_translation_m, promise.max_rmse_m);
  EXPECT_LE(promise.over_ok ? summary.rmse_ok_rotation_rad : summary.rmse_rotation_rad, promise.max_rmse_rad);
}

// All pairs of a set against its promises; adds to the counts of pairs and of right poses that were rejected.
void CheckSet(const SetPromise& set, int& num_pairs, int& num_rejected_right) {
  const absl::StatusOr<sim::Simulation> simulation = Simulated(set.preset);
  ASSERT_THAT(simulation, IsOk());
  const std::vector<Prepared> scans = PreparedScans(*simulation);
  for (const Promise& promise : set.promises) {
    const std::string name = set.preset + " every " + std::to_string(promise.every);
    SCOPED_TRACE(name);
    std::vector<PairOutcome> outcomes;
    for (int target = 0; target + promise.every < simulation->num_scans(); ++target) {
      const int source = target + promise.every;
      outcomes.push_back(Register(scans, source, target,
                                  simulation->T_world_scan(target).inverse() * simulation->T_world_scan(source)));
    }
    const MethodSummary summary = Summarise(outcomes);
    testing::PrintSummary(name, summary);
    testing::PrintTroubles(outcomes);
    ExpectKept(promise, summary);
    num_pairs += summary.pairs;
    num_rejected_right += summary.rejected_right;
  }
}

// One test, because right poses rejected are counted over all sets together.
TEST(SimulatedAccuracyTest, EverySetKeepsItsPromises) {
  int num_pairs = 0;
  int num_rejected_right = 0;
  testing::PrintHeader();
  for (const SetPromise& set : Promises()) CheckSet(set, num_pairs, num_rejected_right);
  std::printf("right poses rejected: %d of %d pairs\n", num_rejected_right, num_pairs);
  EXPECT_GT(num_pairs, 700);
  EXPECT_LE(num_rejected_right, 0.01 * num_pairs);
}

TEST(SimulatedAccuracyTest, NoNegativePairIsAccepted) {
  const absl::StatusOr<sim::Simulation> simulation = Simulated("negatives");
  ASSERT_THAT(simulation, IsOk());
  const std::vector<Prepared> scans = PreparedScans(*simulation);
  std::vector<PairOutcome> outcomes;
  for (const auto& [source, target] : simulation->NegativePairs()) {
    outcomes.push_back(Register(scans, source, target, std::nullopt));
  }
  const MethodSummary summary = Summarise(outcomes);
  testing::PrintHeader();
  testing::PrintSummary("negatives", summary);
  testing::PrintTroubles(outcomes);
  EXPECT_EQ(summary.negatives, 200);
  EXPECT_EQ(summary.negatives_accepted, 0);
  EXPECT_EQ(summary.failed_calls, 0);
}

}  // namespace
}  // namespace curvereg
