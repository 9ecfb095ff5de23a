// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The promised figures on real scans, one setting for all, as they are and with every scan turned to a random attitude.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "eval/dataset.h"
#include "files/cloud_file.h"
#include "tests/testing/evaluation.h"
#include "tests/testing/matchers.h"
#include "tests/testing/scenes.h"
#include "tests/testing/test_data.h"

namespace curvereg {
namespace {

using testing::IsOk;
using testing::Prepared;

constexpr int kNumThreads = 2;
constexpr double kFairOverlap = 0.3;

enum class Attitude { kAsMeasured, kRandom };

// Evenly distributed over all rotations (a normalised Gaussian quaternion).
RigidTransform RandomAttitude(testing::Random& random) {
  const Eigen::Vector4d q(random.Gaussian(), random.Gaussian(), random.Gaussian(), random.Gaussian());
  return RigidTransform(Eigen::Quaterniond(q.normalized()));
}

struct TurnedScan {
  RigidTransform T_turned_scan;
  Prepared scan;
};

// Scans by name.
absl::StatusOr<std::map<std::string, TurnedScan>> ReadScans(const Dataset& dataset, Attitude attitude) {
  testing::Random random(20260101);
  std::map<std::string, TurnedScan> scans;
  for (size_t i = 0; i < dataset.scan_names.size(); ++i) {
    const absl::StatusOr<Scan> scan = ReadCloudFile(dataset.scan_paths[i]);
    if (!scan.ok()) return scan.status();
    TurnedScan turned{RigidTransform::Identity(), nullptr};
    if (attitude == Attitude::kRandom) turned.T_turned_scan = RandomAttitude(random);
    turned.scan = testing::PrepareScan(TransformScan(*scan, turned.T_turned_scan), kNumThreads);
    if (turned.scan == nullptr) return absl::InvalidArgumentError("unusable scan " + dataset.scan_paths[i]);
    scans[dataset.scan_names[i]] = turned;
  }
  return scans;
}

absl::StatusOr<std::vector<PairOutcome>> RegisterAll(const std::string& folder, Attitude attitude) {
  const absl::StatusOr<Dataset> dataset = LoadDataset(folder);
  if (!dataset.ok()) return dataset.status();
  const absl::StatusOr<std::map<std::string, TurnedScan>> scans = ReadScans(*dataset, attitude);
  if (!scans.ok()) return scans.status();
  RegistrationOptions options;
  options.num_threads = kNumThreads;
  std::vector<PairOutcome> outcomes;
  for (const ScanPair& pair : dataset->pairs) {
    const TurnedScan& source = scans->at(pair.source);
    const TurnedScan& target = scans->at(pair.target);
    const RigidTransform truth = target.T_turned_scan * pair.T_target_source * source.T_turned_scan.inverse();
    outcomes.push_back(testing::RegisterPair(source.scan, target.scan, truth, options));
    outcomes.back().source = pair.source;
    outcomes.back().target = pair.target;
    outcomes.back().overlap = pair.overlap;
  }
  return outcomes;
}

template <typename Keep>
std::vector<PairOutcome> Where(const std::vector<PairOutcome>& outcomes, const Keep& keep) {
  std::vector<PairOutcome> kept;
  std::copy_if(outcomes.begin(), outcomes.end(), std::back_inserter(kept), keep);
  return kept;
}

class RealScansTest : public ::testing::TestWithParam<Attitude> {
 protected:
  // Empty when the set is not on this machine, or cannot be read (a failure then).
  std::vector<PairOutcome> OutcomesOf(const std::string& set) {
    const std::optional<std::string> folder = testing::RealDataPath(set);
    if (!folder.has_value()) return {};
    const absl::StatusOr<std::vector<PairOutcome>> outcomes = RegisterAll(*folder, GetParam());
    EXPECT_THAT(outcomes, IsOk());
    if (!outcomes.ok()) return {};
    EXPECT_FALSE(outcomes->empty());
    return *outcomes;
  }
};

TEST_P(RealScansTest, SmallSetsAreAllOk) {
  testing::PrintHeader();
  for (const std::string set : {"a3_3dtk_kurt3d", "a4_libpointmatcher_car", "a5_libpointmatcher_apartment",
                                "b2_kitti00", "b4_small_gicp_hdl32", "b7_nuscenes_kcp"}) {
    SCOPED_TRACE(set);
    if (!testing::RealDataPath(set).has_value()) GTEST_SKIP() << "no real data set " << set << " on this machine";
    // The truth of this pair is no better known than its mirror image along the corridor (README of the set).
    const std::vector<PairOutcome> outcomes = Where(OutcomesOf(set), [](const PairOutcome& outcome) {
      return !(outcome.source == "scan002" && outcome.target == "scan000");
    });
    const MethodSummary summary = Summarise(outcomes);
    testing::PrintSummary(set, summary);
    testing::PrintTroubles(outcomes);
    EXPECT_GT(summary.pairs, 0);
    EXPECT_EQ(summary.ok, summary.pairs);
    EXPECT_EQ(summary.accepted_wrong, 0);
  }
}

bool IsOdd(const std::string& frame) { return (frame.back() - '0') % 2 == 1; }
bool HasOddFrame(const PairOutcome& outcome) { return IsOdd(outcome.source) || IsOdd(outcome.target); }
bool HasFairOverlap(const PairOutcome& outcome) { return outcome.overlap >= kFairOverlap; }

// The promises for hand-held scans in a hall, checked on some of its pairs.
void ExpectHallPromises(const std::string& name, const std::vector<PairOutcome>& outcomes) {
  SCOPED_TRACE(name);
  const SuccessBounds close{0.1, std::numbers::pi / 180.0};
  const std::vector<PairOutcome> fair = Where(outcomes, HasFairOverlap);
  const std::vector<PairOutcome> poor = Where(outcomes, [](const auto& outcome) { return !HasFairOverlap(outcome); });
  const MethodSummary of_fair = Summarise(fair);
  const MethodSummary of_poor = Summarise(poor);
  const int num_close = Summarise(fair, close).ok;
  testing::PrintSummary(name + ", overlap >= 0.3", of_fair);
  testing::PrintSummary(name + ", overlap < 0.3", of_poor);
  std::printf("%-34s %5d of %d fair pairs within 0.1 m and 1 degree\n", name.c_str(), num_close, of_fair.pairs);
  EXPECT_GE(of_fair.ok, 0.95 * of_fair.pairs);
  EXPECT_GE(num_close, 0.85 * of_fair.pairs);
  EXPECT_GE(of_poor.ok, 0.5 * of_poor.pairs);
  EXPECT_EQ(of_fair.accepted_wrong + of_poor.accepted_wrong, 0);
  EXPECT_EQ(of_fair.failed_calls + of_poor.failed_calls, 0);
}

TEST_P(RealScansTest, HallScansAtAnyAttitude) {
  const std::string set = "a1_hilti2021_os0_hall";
  if (!testing::RealDataPath(set).has_value()) GTEST_SKIP() << "no real data set " << set << " on this machine";
  const std::vector<PairOutcome> outcomes = OutcomesOf(set);
  testing::PrintHeader();
  testing::PrintTroubles(outcomes);
  ExpectHallPromises("a1", outcomes);
  // Settings were tuned on even frames alone: pairs with an odd one tell how they carry over.
  ExpectHallPromises("a1 even", Where(outcomes, [](const auto& outcome) { return !HasOddFrame(outcome); }));
  ExpectHallPromises("a1 with odd", Where(outcomes, HasOddFrame));
}

INSTANTIATE_TEST_SUITE_P(Attitudes, RealScansTest, ::testing::Values(Attitude::kAsMeasured, Attitude::kRandom),
                         [](const auto& attitude) {
                           return attitude.param == Attitude::kAsMeasured ? "AsMeasured" : "Random";
                         });

}  // namespace
}  // namespace curvereg
