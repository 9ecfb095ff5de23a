// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulated_dataset.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "files/cloud_file.h"
#include "files/trajectory_file.h"
#include "tests/testing/test_data.h"

namespace curvereg::cli {
namespace {

sim::Simulation Small(bool separate_worlds = false) {
  sim::SimulationOptions options;
  options.num_scans = separate_worlds ? 5 : 3;
  options.separate_worlds = separate_worlds;
  options.scanner.pattern.columns = 60;
  options.scanner.pattern.rows = 40;
  absl::StatusOr<sim::Simulation> simulation = sim::Simulation::Create(options);
  EXPECT_TRUE(simulation.ok()) << simulation.status();
  return *std::move(simulation);
}

TEST(SimulatedDatasetTest, FilesHoldTheScansAndTheTruth) {
  const testing::TemporaryFolder folder;
  const sim::Simulation simulation = Small();
  int num_done = 0;
  SimulatedDatasetOptions options;
  options.progress = [&](int done) { num_done = done; };
  const absl::StatusOr<SimulatedDatasetSummary> summary = WriteSimulatedDataset(simulation, folder.path(), options);
  ASSERT_TRUE(summary.ok()) << summary.status();
  EXPECT_EQ(num_done, 3);
  const absl::StatusOr<std::vector<StampedPose>> poses = ReadTrajectoryFile(folder.File("poses.txt"));
  ASSERT_TRUE(poses.ok()) << poses.status();
  ASSERT_EQ(poses->size(), 3U);
  int64_t num_points = 0;
  for (int i = 0; i < 3; ++i) {
    const absl::StatusOr<Scan> scan = ReadCloudFile(folder.File(SimulatedScanName(i) + ".pcd"));
    ASSERT_TRUE(scan.ok()) << scan.status();
    EXPECT_EQ(ScanDigest(*scan), ScanDigest(simulation.ScanAt(i)));
    num_points += static_cast<int64_t>(scan->points.size());
    const TransformDifference off =
        Difference((*poses)[static_cast<std::size_t>(i)].T_world_scan, simulation.T_world_scan(i));
    EXPECT_LT(off.translation_m, 1e-9);
    EXPECT_LT(off.rotation_rad, 1e-7);
  }
  EXPECT_EQ(summary->num_points, num_points);
  EXPECT_NEAR(summary->mean_step_m, 5.4, 1.5);
  EXPECT_TRUE(WriteSimulatedDataset(simulation, folder.path(), {}).ok()) << "overwrites its own files";
}

TEST(SimulatedDatasetTest, LeftoversOfAnotherDataSetAreRefused) {
  const testing::TemporaryFolder folder;
  std::ofstream(folder.File("0003.pcd")) << "left over";
  const absl::Status status = WriteSimulatedDataset(Small(), folder.path(), {}).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_NE(status.message().find("0003.pcd"), absl::string_view::npos) << status;
  EXPECT_FALSE(std::filesystem::exists(folder.File("0000.pcd")));
  EXPECT_FALSE(WriteSimulatedDataset(Small(), folder.File("missing"), {}).ok());
}

TEST(SimulatedDatasetTest, NegativePairsHaveNoPoses) {
  const testing::TemporaryFolder folder;
  const sim::Simulation simulation = Small(true);
  ASSERT_TRUE(WriteSimulatedDataset(simulation, folder.path(), {}).ok());
  EXPECT_FALSE(std::filesystem::exists(folder.File("poses.txt")));
  std::ifstream file(folder.File("negatives.txt"));
  std::string line;
  std::size_t num_pairs = 0;
  while (std::getline(file, line)) num_pairs += line.starts_with('#') ? 0 : 1;
  EXPECT_GT(num_pairs, 0U);
  EXPECT_EQ(num_pairs, simulation.NegativePairs().size());
}

TEST(SimulatedDatasetTest, StopsWhenInterrupted) {
  const testing::TemporaryFolder folder;
  std::stop_source source;
  source.request_stop();
  SimulatedDatasetOptions options;
  options.cancellation = source.get_token();
  EXPECT_EQ(WriteSimulatedDataset(Small(), folder.path(), options).status().code(), absl::StatusCode::kCancelled);
  EXPECT_FALSE(std::filesystem::exists(folder.File("poses.txt"))) << "no truth without its scans";
}

}  // namespace
}  // namespace curvereg::cli
