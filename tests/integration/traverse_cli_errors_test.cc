// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The built command line's commands about traverses when something is wrong: what they say, and what they leave.
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "files/trajectory_file.h"
#include "tests/testing/command_line_test.h"

namespace curvereg {
namespace {

namespace fs = std::filesystem;
using testing::Finished;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::ReadFile;

class TraverseCliErrorsTest : public testing::CommandLineTest {
 protected:
  static void SetUpTestSuite() {
    Start({"--log-level", "error"});
    ASSERT_EQ(Alone("simulate --preset sparse --scans 3 --seed 5 --out yard").status, 0);
    const Finished streamed = Asking("stream yard --traverse drive");
    ASSERT_EQ(streamed.status, 0) << streamed.err << streamed.out;
  }
  // The yard's poses, changed, in a file of the folder.
  static void WriteOdometry(const std::string& name, const std::vector<double>& times) {
    auto poses = ReadTrajectoryFile(File("yard/poses.txt"));
    ASSERT_TRUE(poses.ok()) << poses.status();
    for (size_t i = 0; i < poses->size(); ++i) (*poses)[i].timestamp_s = times[i];
    ASSERT_TRUE(WriteTrajectoryFile(File(name), *poses).ok());
  }
};

TEST_F(TraverseCliErrorsTest, AMistakeLeavesNoTraverseBehind) {
  fs::create_directory(File("empty"));
  std::ofstream(File("columns.txt")) << "1 2 3 4 5\n";
  for (const char* arguments :
       {"stream nowhere", "stream empty", "stream --follow nowhere", "stream yard --priors nowhere.txt",
        "stream yard --priors columns.txt", "stream yard --prior-sigma 1,1", "stream yard --idle-end 3",
        "stream yard --method guess"}) {
    const Finished finished = Asking(std::string(arguments) + " --traverse mistake");
    EXPECT_EQ(finished.status, 2) << arguments << finished.err;
    EXPECT_THAT(finished.err, HasSubstr("curvereg: ")) << arguments;
  }
  EXPECT_THAT(Asking("traverse list").out, Not(HasSubstr("mistake")));
}

TEST_F(TraverseCliErrorsTest, TimesOfOdometryMustGrow) {
  WriteOdometry("unsorted.txt", {100.0, 102.0, 101.0});
  WriteOdometry("twice.txt", {100.0, 101.0, 101.0});
  for (const char* name : {"unsorted.txt", "twice.txt"}) {
    const Finished finished = Asking(std::string("stream yard --traverse times --priors ") + name);
    EXPECT_EQ(finished.status, 2) << finished.err;
    EXPECT_THAT(finished.err, HasSubstr(std::string(name) + ": the time of pose 3 is not after that of pose 2"));
  }
  WriteOdometry("far.txt", {1e20, 2e20, 3e20});  // more nanoseconds than 64 bits hold
  EXPECT_THAT(Asking("stream yard --traverse times --priors far.txt").err, HasSubstr("not a time"));
}

TEST_F(TraverseCliErrorsTest, OdometryAmongTheScansIsNoScan) {
  fs::copy(File("yard"), File("together"));
  WriteOdometry("together/wheels.txt", {100.0, 101.0, 102.0});
  const Finished finished = Asking("stream together --traverse together --priors together/wheels.txt");
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_THAT(finished.out, HasSubstr("3 scans sent"));
}

TEST_F(TraverseCliErrorsTest, ATakenNameIsABadArgument) {
  const Finished other = Asking("stream yard --traverse drive --method icp");
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err, HasSubstr("choose another name"));
  const Finished resumed = Asking("stream yard --traverse drive --method icp --resume");
  EXPECT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_THAT(resumed.err, HasSubstr("keeps the method it was created with, curvelet"));
  EXPECT_THAT(Asking("stream yard --traverse drive --resume").err, IsEmpty());
}

TEST_F(TraverseCliErrorsTest, AnEventThatIsNotThereIsNotWaitedFor) {
  const auto start = std::chrono::steady_clock::now();
  const Finished finished = Asking("watch drive --once --from 99999");
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30)) << "of --timeout, which is 120";
  EXPECT_EQ(finished.status, 2);
  EXPECT_THAT(finished.err, HasSubstr("no event of that number"));
  const Finished unknown = Asking("watch nothing --once");
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.out, IsEmpty()) << "no header over nothing";
}

TEST_F(TraverseCliErrorsTest, AFullDiskIsSaidOnce) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  const std::string server = " --server " + server_->target();
  const Finished finished = testing::RunIn(
      folder_->path(), "('" CURVEREG_EXECUTABLE "' stream yard --traverse full" + server + " >/dev/full)");
  EXPECT_EQ(finished.status, 2);
  EXPECT_EQ(finished.err, "curvereg: standard output: the result could not be written\n");
  EXPECT_THAT(Asking("traverse show full").out, HasSubstr("3 registered")) << "the scans are safe all the same";
}

TEST_F(TraverseCliErrorsTest, AnInterruptedStreamTellsWhatIsSafe) {
  const Finished finished = Alone("stream yard --traverse slow --rate 1 --server " + server_->target(),
                                  "timeout --preserve-status -s INT 1.5");
  EXPECT_EQ(finished.status, 1) << finished.err;
  EXPECT_THAT(finished.err, HasSubstr("curvereg: interrupted"));
  const Finished rest = Asking("stream yard --traverse slow --resume");
  EXPECT_EQ(rest.status, 0) << rest.err;
  EXPECT_THAT(rest.out, HasSubstr("3 registered in all"));
}

TEST_F(TraverseCliErrorsTest, ATraverseThatIsDeletedEndsItsStream) {
  fs::copy(File("yard"), File("growing"));
  fs::remove(File(".out"));  // of the test before
  Finished streamed;
  std::chrono::steady_clock::time_point deleted;
  {
    std::jthread rover([&] { streamed = Asking("stream --follow growing --traverse short-lived --idle-end 60"); });
    for (int i = 0; i < 100 && ReadFile(File(".out")).find("accepted") == std::string::npos; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    const std::string command = "'" CURVEREG_EXECUTABLE "' traverse delete short-lived --server " + server_->target();
    fs::create_directory(File("elsewhere"));
    EXPECT_EQ(testing::RunIn(File("elsewhere"), command).status, 0);
    deleted = std::chrono::steady_clock::now();
  }
  EXPECT_LT(std::chrono::steady_clock::now() - deleted, std::chrono::seconds(40)) << "no scan need come to notice";
  EXPECT_EQ(streamed.status, 2) << streamed.err;
  EXPECT_THAT(streamed.err, HasSubstr("was deleted during the stream"));
}

TEST_F(TraverseCliErrorsTest, ADataFolderThatCannotBeIsABadArgument) {
  for (const char* command : {"traverse list", "watch drive --once", "trajectory drive", "map drive --out m.ply"}) {
    const Finished finished = Alone(std::string(command) + " --data-dir not-there");
    EXPECT_EQ(finished.status, 2) << command << finished.err;
    EXPECT_THAT(finished.err, HasSubstr("not-there: no such data folder")) << command;
  }
  EXPECT_FALSE(fs::exists(File("not-there"))) << "looking makes no folder";
  const Finished below = Alone("stream yard --traverse x --data-dir yard/0000.pcd/below");
  EXPECT_EQ(below.status, 2) << below.err;
  EXPECT_THAT(below.err, HasSubstr("--data-dir: "));
}

TEST_F(TraverseCliErrorsTest, AnEmptyTraverseHasNothingToShow) {
  fs::create_directory(File("cut"));
  std::ofstream(File("cut/0000.pcd"), std::ios::binary) << ReadFile(File("yard/0000.pcd")).substr(0, 5000);
  const Finished streamed = Asking("stream cut --traverse empty");
  EXPECT_EQ(streamed.status, 2);
  EXPECT_THAT(streamed.err, HasSubstr("cut/0000.pcd: truncated"));
  EXPECT_THAT(Asking("trajectory empty").err, HasSubstr("has no poses yet"));
  EXPECT_EQ(Asking("map empty --out empty.ply").status, 2);
  EXPECT_FALSE(fs::exists(File("empty.ply")));
  EXPECT_EQ(Asking("traverse optimize empty").status, 0);
  EXPECT_EQ(Asking("traverse report empty --out empty-report").status, 0);
}

}  // namespace
}  // namespace curvereg
