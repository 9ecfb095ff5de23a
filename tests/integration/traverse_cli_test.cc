// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The built command line's commands about traverses against the built server.
#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "files/cloud_file.h"
#include "files/trajectory_file.h"
#include "tests/testing/command_line_test.h"

namespace curvereg {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::Finished;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::ReadFile;

std::vector<json> Lines(const std::string& text) {
  std::vector<json> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(json::parse(line));
  return lines;
}

class TraverseCliTest : public testing::CommandLineTest {
 protected:
  static constexpr int kNumScans = 5;
  static void SetUpTestSuite() {
    Start({"--log-level", "error"});
    ASSERT_EQ(Alone("simulate --preset sparse --scans 5 --seed 5 --out yard").status, 0);
    const Finished streamed = Asking("stream yard --traverse drive --json");
    ASSERT_EQ(streamed.status, 0) << streamed.err << streamed.out;
    streamed_ = new std::string(streamed.out);
  }
  static void TearDownTestSuite() {
    delete streamed_;
    CommandLineTest::TearDownTestSuite();
  }

  static inline std::string* streamed_ = nullptr;  // what `stream` printed
};

TEST_F(TraverseCliTest, StreamPrintsAResultALineAndASummary) {
  const std::vector<json> lines = Lines(*streamed_);
  ASSERT_EQ(lines.size(), kNumScans + 1U);
  for (int i = 0; i < kNumScans; ++i) EXPECT_EQ(lines[i]["sequence_number"], i);
  EXPECT_EQ(lines[0]["pose"]["origin"], "segment_start");
  EXPECT_EQ(lines[1]["pose"]["origin"], "registered");
  EXPECT_EQ(lines[1]["links"][0]["accepted"], true);
  const json& summary = lines.back()["summary"];
  EXPECT_EQ(summary["name"], "traverses/drive");
  EXPECT_EQ(summary["num_registered_scans"], kNumScans);
  EXPECT_EQ(summary["num_sent"], kNumScans);
  EXPECT_EQ(summary["bytes_resent"], 0);
}

TEST_F(TraverseCliTest, StreamGoesOnOnlyWhenAskedTo) {
  const Finished again = Asking("stream yard --traverse drive");
  EXPECT_EQ(again.status, 2);
  EXPECT_THAT(again.err, HasSubstr("--resume"));
  const Finished resumed = Asking("stream yard --traverse drive --resume --json");
  EXPECT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_EQ(Lines(resumed.out).back()["summary"]["num_sent"], 0);
}

TEST_F(TraverseCliTest, StreamResumesWithTheRestAndPriorsAndOptimises) {
  fs::create_directory(File("part"));
  for (const char* name : {"0000.pcd", "0001.pcd"}) fs::copy(File("yard") + "/" + name, File("part") + "/" + name);
  const Finished first = Asking("stream part --traverse parts");
  EXPECT_EQ(first.status, 0) << first.err;
  EXPECT_THAT(first.out, HasSubstr("overlap"));
  EXPECT_THAT(first.out, HasSubstr("2 scans sent, 2 registered in all"));
  auto odometry = ReadTrajectoryFile(File("yard/poses.txt"));
  ASSERT_TRUE(odometry.ok()) << odometry.status();
  for (StampedPose& pose : *odometry) pose.timestamp_s += 100.5;  // else they are but numbers of lines
  ASSERT_TRUE(WriteTrajectoryFile(File("odometry.txt"), *odometry).ok());
  const Finished rest = Asking(
      "stream yard --traverse parts --resume --priors odometry.txt --prior-sigma 0.05,0.5 --rate 50 --optimize "
      "--json");
  EXPECT_EQ(rest.status, 0) << rest.err;
  const std::vector<json> lines = Lines(rest.out);
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_EQ(lines[0]["sequence_number"], 2);
  EXPECT_EQ(lines[0]["pose"]["time_ns"], 102'500'000'000);
  EXPECT_GE(lines[3]["summary"]["optimization"]["num_links"], 4);
  EXPECT_EQ(Asking("traverse delete parts").status, 0);
}

TEST_F(TraverseCliTest, StreamFollowsAFolderThatGrows) {
  fs::create_directory(File("incoming"));
  std::jthread rover([] {
    for (int i = 0; i < 3; ++i) {
      const std::string name = "/000" + std::to_string(i) + ".pcd";
      fs::copy(File("yard") + name, File("incoming") + name + ".part");
      fs::rename(File("incoming") + name + ".part", File("incoming") + name);
      std::this_thread::sleep_for(std::chrono::milliseconds(400));
    }
  });
  const Finished followed = Asking("stream --follow incoming --traverse followed --idle-end 2 --json");
  EXPECT_EQ(followed.status, 0) << followed.err;
  EXPECT_EQ(Lines(followed.out).size(), 4U);
  EXPECT_EQ(Asking("traverse delete traverses/followed --json").out, "{\"deleted\":\"traverses/followed\"}\n");
}

TEST_F(TraverseCliTest, InterruptingAWatchedFolderStillOptimises) {
  const Finished ended =
      Alone("stream --follow yard --traverse watched --optimize --json --server " + server_->target(),
            "timeout --preserve-status -s INT 5");
  EXPECT_EQ(ended.status, 0) << ended.err;
  const std::vector<json> lines = Lines(ended.out);
  ASSERT_FALSE(lines.empty());
  EXPECT_TRUE(lines.back()["summary"].contains("optimization")) << ended.out;
  EXPECT_EQ(Asking("traverse delete watched").status, 0);
}

TEST_F(TraverseCliTest, WatchShowsWhatHappened) {
  const Finished table = Asking("watch drive --once");
  EXPECT_EQ(table.status, 0) << table.err;
  EXPECT_THAT(table.out, HasSubstr("accepted"));
  const Finished events = Asking("watch drive --once --json");
  EXPECT_EQ(events.status, 0) << events.err;
  const std::vector<json> lines = Lines(events.out);
  ASSERT_GE(lines.size(), static_cast<size_t>(kNumScans));
  for (size_t i = 0; i < lines.size(); ++i) EXPECT_EQ(lines[i]["event"], i);
  EXPECT_EQ(lines[0]["result"]["sequence_number"], 0);
  const Finished later = Asking("watch drive --once --json --from 3");
  EXPECT_EQ(Lines(later.out).front()["event"], 3);
}

TEST_F(TraverseCliTest, TrajectoryIsNearTheTruth) {
  const Finished printed = Asking("trajectory drive");
  EXPECT_EQ(printed.status, 0) << printed.err;
  EXPECT_THAT(printed.out, HasSubstr("segment 0 of traverses/drive frame"));
  EXPECT_EQ(Asking("trajectory drive --out drive.tum").status, 0);
  EXPECT_EQ(ReadFile(File("drive.tum")), printed.out);
  const auto poses = ReadTrajectoryFile(File("drive.tum"));
  const auto truth = ReadTrajectoryFile(File("yard/poses.txt"));
  ASSERT_TRUE(poses.ok()) << poses.status();
  ASSERT_TRUE(truth.ok()) << truth.status();
  ASSERT_EQ(poses->size(), truth->size());
  const RigidTransform T_first_world = truth->front().T_world_scan.inverse();
  for (size_t i = 0; i < poses->size(); ++i) {
    const RigidTransform T_true = T_first_world * (*truth)[i].T_world_scan;
    EXPECT_LT((T_true.translation() - (*poses)[i].T_world_scan.translation()).norm(), 0.1) << i;
  }
  EXPECT_EQ(Asking("trajectory drive --format kitti --out drive.kitti").status, 0);
  const auto kitti = ReadTrajectoryFile(File("drive.kitti"));
  ASSERT_TRUE(kitti.ok());
  EXPECT_TRUE(kitti->back().T_world_scan.isApprox(poses->back().T_world_scan, 1e-9));
  EXPECT_EQ(json::parse(Asking("trajectory drive --json").out)["poses"].size(), kNumScans);
  EXPECT_EQ(Asking("trajectory drive --segment 7").status, 2);
}

TEST_F(TraverseCliTest, MapsComeAsCloudsAndAsGrids) {
  const Finished cloud = Asking("map drive --out map.ply --cell 0.2 --json");
  EXPECT_EQ(cloud.status, 0) << cloud.err;
  const auto points = ReadCloudFile(File("map.ply"));
  ASSERT_TRUE(points.ok()) << points.status();
  EXPECT_EQ(json::parse(cloud.out)["num_cells"], points->points.size());
  EXPECT_GT(points->points.size(), 1000U);
  const Finished cleaned = Asking("map drive --out cleaned.pcd --cell 0.2 --remove-dynamic");
  EXPECT_EQ(cleaned.status, 0) << cleaned.err;
  EXPECT_EQ(cleaned.err.find("warning"), std::string::npos) << cleaned.err;
  const Finished by_old_name = Asking("map drive --out by_old_name.pcd --cell 0.2 --remove-seen-through");
  EXPECT_EQ(by_old_name.status, 0) << by_old_name.err;
  EXPECT_THAT(by_old_name.err, HasSubstr("--remove-dynamic"));
  EXPECT_EQ(ReadFile(File("by_old_name.pcd")), ReadFile(File("cleaned.pcd")));
  EXPECT_EQ(Asking("map drive --out heights.asc --cell 0.5").status, 0);
  EXPECT_THAT(ReadFile(File("heights.asc")), HasSubstr("ncols"));
  EXPECT_EQ(Asking("map drive --out map.tiff").status, 2);
  EXPECT_EQ(Asking("map drive --out nowhere/map.ply").status, 2);
}

TEST_F(TraverseCliTest, TraversesAreListedShownOptimisedAndDeleted) {
  EXPECT_THAT(Asking("traverse list").out, HasSubstr("traverses/drive"));
  EXPECT_EQ(json::parse(Asking("traverse list --json").out)["traverses"].back()["name"], "traverses/drive");
  EXPECT_THAT(Asking("traverse show drive").out, HasSubstr("curvelet"));
  const Finished optimised = Asking("traverse optimize drive --json");
  EXPECT_EQ(optimised.status, 0) << optimised.err;
  EXPECT_GE(json::parse(optimised.out)["num_links"], kNumScans - 1);
  EXPECT_EQ(Asking("traverse show nothing").status, 2);
  EXPECT_EQ(Asking("traverse delete nothing").status, 2);
}

TEST_F(TraverseCliTest, ReportsHoldEverything) {
  fs::create_directory(File("drive-report"));
  std::ofstream(File("drive-report/trajectory_7.tum")) << "of a segment that was joined since\n";
  std::ofstream(File("drive-report/trajectory_truth.tum")) << "of an evaluation\n";
  const Finished report = Asking("traverse report drive --out drive-report --json");
  ASSERT_EQ(report.status, 0) << report.err;
  EXPECT_EQ(json::parse(report.out)["num_poses"], kNumScans);
  const std::string page = ReadFile(File("drive-report/report.html"));
  EXPECT_THAT(page, HasSubstr("traverses/drive"));
  EXPECT_THAT(page, HasSubstr("</html>"));
  const json data = json::parse(ReadFile(File("drive-report/report.json")));
  EXPECT_EQ(data["scans"].size(), kNumScans);
  EXPECT_TRUE(data["scans"][1]["position_covariance"].is_array());
  EXPECT_TRUE(fs::exists(File("drive-report/trajectory_0.tum")));
  EXPECT_FALSE(fs::exists(File("drive-report/trajectory_7.tum")));
  EXPECT_TRUE(fs::exists(File("drive-report/trajectory_truth.tum")));
  EXPECT_TRUE(fs::exists(File("drive-report/map.ply")));
  if (report.err.find("matplotlib") != std::string::npos) return;  // said aloud by the command
  for (const char* figure : {"figure_1_trajectory.png", "figure_2_map.png", "figure_3_verdicts.png"}) {
    EXPECT_TRUE(fs::exists(File("drive-report") + "/" + figure)) << figure;
  }
  EXPECT_THAT(page, HasSubstr("data:image/png"));
}

TEST_F(TraverseCliTest, WorksAloneOverADataFolder) {
  const Finished streamed = Alone("stream yard --traverse alone --data-dir own-data --json");
  EXPECT_EQ(streamed.status, 0) << streamed.err;
  const Finished shown = Alone("traverse show alone --data-dir own-data --json");
  EXPECT_EQ(shown.status, 0) << shown.err;
  EXPECT_EQ(json::parse(shown.out)["num_registered_scans"], kNumScans);
  const json here = Lines(streamed.out)[kNumScans - 1]["pose"]["T_segment_scan"];
  EXPECT_EQ(here, Lines(*streamed_)[kNumScans - 1]["pose"]["T_segment_scan"]) << "the same answer as a server's";
}

TEST_F(TraverseCliTest, SaysWhatIsWrong) {
  EXPECT_EQ(Asking("stream --traverse x").status, 2);
  EXPECT_EQ(Asking("stream nowhere --traverse x").status, 2);
  EXPECT_EQ(Asking("stream yard --traverse NOT_A_NAME").status, 2);
  EXPECT_EQ(Asking("stream yard --traverse x --priors yard/0000.pcd").status, 2);
  EXPECT_EQ(Asking("stream yard --traverse x --idle-end 3").status, 2);
  EXPECT_EQ(Asking("watch nothing --once").status, 2);
  const Finished unreachable = Alone("trajectory drive --server 127.0.0.1:1 --timeout 2");
  EXPECT_EQ(unreachable.status, 4);
  EXPECT_THAT(unreachable.out, IsEmpty());
}

}  // namespace
}  // namespace curvereg
