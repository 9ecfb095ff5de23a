// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What is promised for whole drives: their trajectories against the truth, with and without optimisation.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/presets.h"
#include "tests/testing/matchers.h"
#include "tests/testing/traverses.h"

namespace curvereg {
namespace {

using testing::DriveScans;
using testing::IsOk;

void PrintErrors(const std::string& name, const Traverse& traverse, const DriveScans& drive) {
  const std::vector<double> errors = testing::PositionErrors(traverse, drive);
  int num_accepted = 0;
  for (const TraverseLink& link : traverse.links) num_accepted += link.result.verdict.accepted ? 1 : 0;
  std::printf("%-44s RMSE %6.2f mm, last %6.2f mm, ATE %6.2f mm, links %3zu, accepted %3d\n", name.c_str(),
              1e3 * testing::RootMeanSquare(errors), 1e3 * errors.back(),
              1e3 * testing::AbsoluteTrajectoryError(traverse, drive), traverse.links.size(), num_accepted);
  std::fflush(stdout);
}

// Tracks the drive's scans one after the other; odometry drifts by `drift` of the way, none without it.
Traverse Track(DriveScans& drive, const std::optional<double>& drift = std::nullopt) {
  Traverse traverse;
  for (uint64_t number = 0; number < drive.size(); ++number) {
    TraverseScan scan{drive.Get(number), std::nullopt, std::nullopt};
    if (drift.has_value() && number > 0) scan.prior = drive.Odometry(number, *drift);
    const absl::StatusOr<TrackedScan> tracked = TrackScan(traverse, scan, drive.Loader(), {});
    EXPECT_THAT(tracked, IsOk());
    if (!tracked.ok()) return traverse;
    AppendScan(traverse, *tracked, scan.prior);
  }
  return traverse;
}

void AddAllLinks(Traverse& traverse, DriveScans& drive) {
  for (uint64_t number = 0; number < drive.size(); ++number) {
    const auto links = FindLinks(traverse, number, drive.Loader(), {});
    ASSERT_THAT(links, IsOk());
    traverse.links.insert(traverse.links.end(), links->begin(), links->end());
  }
  const auto closures = FindLoopClosures(traverse, drive.Loader(), {});
  ASSERT_THAT(closures, IsOk());
  traverse.links.insert(traverse.links.end(), closures->begin(), closures->end());
}

void Revise(Traverse& traverse) {
  const absl::StatusOr<TraverseRevision> revision = ReviseTraverse(traverse, {});
  ASSERT_THAT(revision, IsOk());
  ApplyRevision(traverse, *revision);
  std::printf("    revised: %zu poses, %d links used, %d given up, %zu joins\n", revision->poses.size(),
              revision->num_links, revision->num_rejected_links, revision->joins.size());
}

double RmseOf(const Traverse& traverse, const DriveScans& drive) {
  return testing::RootMeanSquare(testing::PositionErrors(traverse, drive));
}

// One link in ten is replaced by a wrong one.
void ExpectWrongLinksToMoveNoPose(const Traverse& linked, const DriveScans& drive) {
  Traverse right = linked;
  Traverse wrong = linked;
  sim::RandomStream random(10);
  int num_wrong = 0;
  for (TraverseLink& link : wrong.links) {
    if (random.Uniform() > 0.1) continue;
    Vector6d delta;
    for (int i = 0; i < 6; ++i) delta[i] = i < 3 ? random.Uniform(-0.5, 0.5) : random.Uniform(-10.0, 10.0);
    link.result.T_target_source = TransformFromVector(delta) * *link.result.T_target_source;
    ++num_wrong;
  }
  ASSERT_GE(num_wrong, 10);
  // What tracking made of the wrong ones.
  for (size_t i = 1; i < wrong.poses.size(); ++i) {
    wrong.poses[i].T_segment_scan = wrong.poses[i - 1].T_segment_scan * *wrong.links[i - 1].result.T_target_source;
  }
  PrintErrors("mars-yard-sim, one link in ten wrong", wrong, drive);
  Revise(right);
  Revise(wrong);
  PrintErrors("mars-yard-sim, these optimised", wrong, drive);
  double worst_m = 0.0;
  for (size_t i = 0; i < right.poses.size(); ++i) {
    const TransformDifference moved = Difference(right.poses[i].T_segment_scan, wrong.poses[i].T_segment_scan);
    worst_m = std::max(worst_m, moved.translation_m);
  }
  std::printf("    %d wrong links moved poses by up to %.2f mm\n", num_wrong, 1e3 * worst_m);
  EXPECT_LE(worst_m, 0.02);
}

// One test, so that the drive is tracked once.
TEST(MarsYardTest, StaysWithinItsPromises) {
  DriveScans drive(*sim::Simulation::Create(*sim::PresetOptions("mars-yard-sim")));
  Traverse traverse = Track(drive);
  PrintErrors("mars-yard-sim, tracking alone", traverse, drive);
  EXPECT_EQ(traverse.num_segments, 1);
  EXPECT_LE(RmseOf(traverse, drive), 0.02);
  AddAllLinks(traverse, drive);
  ExpectWrongLinksToMoveNoPose(traverse, drive);
  Revise(traverse);
  PrintErrors("mars-yard-sim, optimised", traverse, drive);
  EXPECT_LE(RmseOf(traverse, drive), 0.01);
}

TEST(MarsYardTest, OdometryAndMissingScansLeaveOneSegment) {
  std::vector<int> kept;
  for (int i = 0; i < sim::PresetOptions("mars-yard-sim")->num_scans; ++i) {
    if (i % 3 != 2) kept.push_back(i);
  }
  DriveScans drive(*sim::Simulation::Create(*sim::PresetOptions("mars-yard-sim")), kept);
  Traverse traverse = Track(drive, 0.05);
  PrintErrors("every third scan missing, odometry off by 5 %", traverse, drive);
  EXPECT_EQ(traverse.num_segments, 1);
  AddAllLinks(traverse, drive);
  Revise(traverse);
  PrintErrors("the same, optimised", traverse, drive);
  EXPECT_LE(RmseOf(traverse, drive), 0.02);
}

TEST(LoopTest, ComesBackToWhereItBegan) {
  sim::SimulationOptions options = *sim::PresetOptions("mars-yard-sim");
  options.num_scans = 24;
  options.traverse.shape = sim::TraverseShape::kLoop;
  options.traverse.loop_radius_m = 18.0;
  DriveScans drive(*sim::Simulation::Create(options));
  Traverse traverse = Track(drive);
  PrintErrors("a loop of 113 m, tracking alone", traverse, drive);
  EXPECT_EQ(traverse.num_segments, 1);
  AddAllLinks(traverse, drive);
  Revise(traverse);
  PrintErrors("a loop of 113 m, optimised", traverse, drive);
  EXPECT_LE(testing::PositionErrors(traverse, drive).back(), 0.01);
  EXPECT_LE(RmseOf(traverse, drive), 0.01);
}

}  // namespace
}  // namespace curvereg
