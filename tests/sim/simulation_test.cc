// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/simulation.h"

#include <gtest/gtest.h>

#include <string>

#include "core/base/parallel.h"

namespace curvereg::sim {
namespace {

SimulationOptions Small() {
  SimulationOptions options;
  options.num_scans = 3;
  options.world.yard.length_m = 40.0;
  options.world.yard.width_m = 30.0;
  options.scanner.pattern.columns = 90;
  options.scanner.pattern.rows = 60;
  return options;
}

std::string DigestsOf(const SimulationOptions& options, int num_threads) {
  std::string digests;
  WithThreadLimit(num_threads, [&] {
    const absl::StatusOr<Simulation> simulation = Simulation::Create(options);
    ASSERT_TRUE(simulation.ok()) << simulation.status();
    for (int i = 0; i < simulation->num_scans(); ++i) digests += ScanDigest(simulation->ScanAt(i)) + " ";
  });
  return digests;
}

TEST(SimulationTest, SameSeedSameBytesAtAnyThreadCount) {
  const std::string reference = DigestsOf(Small(), 1);
  EXPECT_EQ(reference.size(), 3U * 17U);
  EXPECT_EQ(DigestsOf(Small(), 2), reference);
  EXPECT_EQ(DigestsOf(Small(), 4), reference);
  SimulationOptions other = Small();
  other.seed = 2;
  EXPECT_NE(DigestsOf(other, 2), reference);
}

TEST(SimulationTest, ScansCanBeAskedForInAnyOrder) {
  const absl::StatusOr<Simulation> simulation = Simulation::Create(Small());
  ASSERT_TRUE(simulation.ok());
  const std::string last = ScanDigest(simulation->ScanAt(2));
  const std::string first = ScanDigest(simulation->ScanAt(0));
  EXPECT_NE(first, last);
  EXPECT_EQ(ScanDigest(simulation->ScanAt(2)), last);
  EXPECT_EQ(ScanDigest(simulation->ScanAt(0)), first);
}

TEST(SimulationTest, SensorStandsAMastAboveTheGround) {
  const absl::StatusOr<Simulation> simulation = Simulation::Create(Small());
  ASSERT_TRUE(simulation.ok());
  for (int i = 0; i < 3; ++i) {
    const RigidTransform& T = simulation->T_world_scan(i);
    EXPECT_TRUE(IsRigid(T, 1e-12));
    const Eigen::Vector3d foot = T * Eigen::Vector3d(0.0, 0.0, -1.8);
    EXPECT_NEAR(foot.z(), simulation->world(i).SurfaceHeight(foot.x(), foot.y()), 0.25);
  }
}

TEST(SimulationTest, ClearedDriveLosesItsTallRocksOnly) {
  SimulationOptions options = Small();
  options.world.yard.rocks.density_per_m2 = 2.0;
  const absl::StatusOr<Simulation> before = Simulation::Create(options);
  options.world.clear_drive = true;
  const absl::StatusOr<Simulation> after = Simulation::Create(options);
  ASSERT_TRUE(before.ok() && after.ok());
  const std::size_t all = before->world(0).rocks().size();
  const std::size_t left = after->world(0).rocks().size();
  EXPECT_LT(left, all);
  EXPECT_GT(left, all * 9 / 10);
}

TEST(SimulationTest, BadOptionsAreNamed) {
  SimulationOptions options = Small();
  options.num_scans = 0;
  EXPECT_EQ(Simulation::Create(options).status().message(), "number of scans is 0; it must be from 1 to 100000");
  options = Small();
  options.scanner.keep_fraction = 1.5;
  EXPECT_EQ(Simulation::Create(options).status().message(), "share of beams kept is 1.5; it must be from 0 to 1");
  options = Small();
  options.world.kind = WorldKind::kElevationModel;
  options.world.elevation.path = "/no/such/model.asc";
  EXPECT_EQ(Simulation::Create(options).status().code(), absl::StatusCode::kNotFound);
  options = Small();
  options.world.yard.width_m = 10.0;
  EXPECT_EQ(Simulation::Create(options).status().code(), absl::StatusCode::kInvalidArgument);
  options = Small();
  options.scanner.noise_m = std::nan("");
  EXPECT_EQ(Simulation::Create(options).status().code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace curvereg::sim
