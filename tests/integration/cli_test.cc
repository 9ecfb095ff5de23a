// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The built executable, run as a user runs it: exit status, standard output, standard error, files.
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "files/trajectory_file.h"
#include "tests/testing/run_command.h"
#include "tests/testing/test_data.h"

namespace curvereg {
namespace {

using nlohmann::json;
using testing::Finished;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::ReadFile;

// Runs `curvereg ARGUMENTS`, after `prefix` (e.g. "timeout 1"), in `folder`.
Finished RunIn(const std::string& folder, const std::string& arguments, const std::string& prefix = "") {
  return testing::RunIn(folder, prefix + " '" CURVEREG_EXECUTABLE "' " + arguments);
}

// Three scans of a yard, two neighbours' pairs; made once for all tests.
class CliTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    data_ = new testing::TemporaryFolder;
    const Finished made = RunIn(data_->path(), "simulate --preset sparse --scans 3 --seed 5 --out yard");
    ASSERT_EQ(made.status, 0) << made.err;
    ASSERT_EQ(RunIn(data_->path(), "simulate --preset negatives --scans 3 --seed 5 --out apart").status, 0);
  }
  static void TearDownTestSuite() { delete data_; }

  static std::string Yard(int scan) { return data_->File("yard/000" + std::to_string(scan) + ".pcd"); }
  static Finished Run(const std::string& arguments, const std::string& prefix = "") {
    return RunIn(data_->path(), arguments, prefix);
  }
  // Fails with the status for bad input, names `culprit` on standard error and leaves standard output alone.
  static void ExpectRefused(const std::string& arguments, const std::string& culprit) {
    const Finished finished = Run(arguments);
    EXPECT_EQ(finished.status, 2) << arguments << "\n" << finished.err;
    EXPECT_THAT(finished.out, IsEmpty()) << arguments;
    EXPECT_THAT(finished.err, HasSubstr(culprit)) << arguments;
  }

  static testing::TemporaryFolder* data_;
};
testing::TemporaryFolder* CliTest::data_ = nullptr;

TEST_F(CliTest, HelpAndVersionAreResults) {
  for (const char* arguments : {"--help", "--version", "register --help", "evaluate --help", "simulate --help"}) {
    const Finished finished = Run(arguments);
    EXPECT_EQ(finished.status, 0) << arguments;
    EXPECT_THAT(finished.err, IsEmpty()) << arguments;
    EXPECT_THAT(finished.out, HasSubstr("curvereg")) << arguments;
  }
}

TEST_F(CliTest, WrongUsage) {
  ExpectRefused("", "subcommand");
  ExpectRefused("registr a b", "registr");
  ExpectRefused("register", "SOURCE");
  ExpectRefused("register a b --no-such-option", "no-such-option");
  ExpectRefused("register a b --method magic", "magic");
  ExpectRefused("register a b --threads -3", "--threads");
  ExpectRefused("register a b --time-budget 0", "--time-budget");
  ExpectRefused("register a b --prior '1 2 3'", "--prior: 1 2 3");
  ExpectRefused("register a b --prior-sigma 0.1,1", "--prior");
  ExpectRefused("register a b --time-budget 1e300", "--time-budget");
  ExpectRefused("register a b --timeout 1e300", "--timeout");
  ExpectRefused("simulate --out r --seed -1", "--seed");
  ExpectRefused("status --server 127.0.0.1:1 --token-file none", "--token-file: none: ");
  ExpectRefused("status --server 127.0.0.1:1 --token-file /dev/null", "--token-file: /dev/null: contains no token");
  ExpectRefused("evaluate yard", "--out");
  ExpectRefused("evaluate yard --out r --every 0", "--every");
  ExpectRefused("evaluate yard --out r --method curvelet,curvelet", "twice");
}

TEST_F(CliTest, AnEmptyValueIsNotTheNextArgument) {
  EXPECT_EQ(Run("register --server= " + Yard(1) + " " + Yard(0) + " --threads 2").status, 0);
  for (const char* option : {"--out-cloud", "--report", "--method", "--prior", "--gravity-source", "--seed",
                             "--threads", "--time-budget", "--json", "--token-file", "--tls", "--tls-ca"}) {
    ExpectRefused("register " + std::string(option) + "= a b", std::string(option) + ": ");
  }
  ExpectRefused("register '' b", "SOURCE: must not be empty");
  ExpectRefused("scans download --out= x", "--out: must not be empty");
  ExpectRefused("--version= register a b", "--version");
}

TEST_F(CliTest, RegistersNeighboursAndAgreesWithTheTruth) {
  const Finished finished = Run("register " + Yard(1) + " " + Yard(0) + " --json --threads 2");
  EXPECT_EQ(finished.status, 0) << finished.out << finished.err;
  EXPECT_THAT(finished.err, IsEmpty());
  const json result = json::parse(finished.out);
  EXPECT_EQ(result["accepted"], true);
  EXPECT_THAT(result["reasons"], IsEmpty());

  const auto poses = ReadTrajectoryFile(data_->File("yard/poses.txt"));
  ASSERT_TRUE(poses.ok()) << poses.status();
  const RigidTransform truth = (*poses)[0].T_world_scan.inverse() * (*poses)[1].T_world_scan;
  RigidTransform T_target_source = RigidTransform::Identity();
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t col = 0; col < 4; ++col) {
      T_target_source(static_cast<int>(row), static_cast<int>(col)) = result["T_target_source"][row][col];
    }
  }
  EXPECT_LT(Difference(truth, T_target_source).translation_m, 0.05);
  EXPECT_LT(Difference(truth, T_target_source).rotation_rad, 0.005);
}

TEST_F(CliTest, TheSameAnswerAtAnyThreadCount) {
  json one = json::parse(Run("register " + Yard(1) + " " + Yard(0) + " --json --threads 1").out);
  json two = json::parse(Run("register " + Yard(1) + " " + Yard(0) + " --json --threads 2").out);
  for (json* result : {&one, &two}) {
    result->erase("stage_times");
    result->erase("total_seconds");
  }
  EXPECT_EQ(one, two);
}

TEST_F(CliTest, NegativePairsAreDoneButRejected) {
  const Finished finished = Run("register apart/0000.pcd apart/0001.pcd --json");
  EXPECT_EQ(finished.status, 3) << finished.out << finished.err;
  const json result = json::parse(finished.out);
  EXPECT_EQ(result["accepted"], false);
  EXPECT_THAT(result["reasons"], Not(IsEmpty()));
}

TEST_F(CliTest, TextForPeopleHasVerdictAndMatrix) {
  const Finished finished = Run("register " + Yard(1) + " " + Yard(0));
  EXPECT_THAT(finished.out, HasSubstr("verdict"));
  EXPECT_THAT(finished.out, HasSubstr("T_target_source"));
  EXPECT_THAT(finished.err, IsEmpty());  // no progress bar: not a terminal
}

TEST_F(CliTest, WritesTheMergedCloudAndTheReport) {
  Run("register " + Yard(1) + " " + Yard(0) + " --out-cloud merged.ply --report deep/report");
  EXPECT_GT(std::filesystem::file_size(data_->File("merged.ply")), 100000u);
  EXPECT_THAT(ReadFile(data_->File("deep/report/report.html")), HasSubstr("data:image/png;base64,"));
  EXPECT_TRUE(json::parse(ReadFile(data_->File("deep/report/result.json"))).contains("evidence"));
}

TEST_F(CliTest, UnusableScansAreNamed) {
  std::ofstream(data_->File("empty.pcd"));
  std::ofstream(data_->File("junk.pcd")) << "this is not a cloud\n";
  std::ofstream(data_->File("one.xyz")) << "1 2 3\n";
  std::ofstream(data_->File("scan.unknown")) << "\x01\x02";
  std::ofstream equal(data_->File("equal.xyz")), line(data_->File("line.xyz")), nan(data_->File("nan.xyz"));
  for (int i = 0; i < 1000; ++i) {
    equal << "1 2 3\n";
    line << i << " 0 0\n";
    nan << "nan nan nan\n";
  }
  for (std::ofstream* file : {&equal, &line, &nan}) file->close();
  std::ofstream(data_->File("cut.pcd"), std::ios::binary) << ReadFile(Yard(0)).substr(0, 5000);
  for (const char* name : {"absent.pcd", "empty.pcd", "junk.pcd", "one.xyz", "scan.unknown", "equal.xyz", "line.xyz",
                           "nan.xyz", "cut.pcd", "yard"}) {
    ExpectRefused(std::string("register --json ") + name + " " + Yard(0), name);
    ExpectRefused(std::string("register --json ") + Yard(0) + " " + name, name);
  }
}

TEST_F(CliTest, OutputsThatCannotBeWrittenAreRefused) {
  const std::string pair = "register " + Yard(1) + " " + Yard(0);
  std::ofstream(data_->File("file")) << "precious";
  ExpectRefused(pair + " --out-cloud no/such/folder/m.ply", "no/such/folder/m.ply");
  ExpectRefused(pair + " --out-cloud " + Yard(0), "is also an input of this command");
  ExpectRefused(pair + " --out-cloud merged.doc", "merged.doc");
  ExpectRefused(pair + " --report file", "is a file");
  ExpectRefused("evaluate yard --out file/below", "file/below");
  EXPECT_EQ(ReadFile(data_->File("file")), "precious");
}

TEST_F(CliTest, AFullDiskIsAnError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  const std::string command =
      "'" CURVEREG_EXECUTABLE "' register " + Yard(1) + " " + Yard(0) + " >/dev/full 2>'" + data_->File("err") + "'";
  const int status = std::system(command.c_str());
  EXPECT_EQ(WEXITSTATUS(status), 2);
  EXPECT_THAT(ReadFile(data_->File("err")), HasSubstr("standard output"));
}

TEST_F(CliTest, EvaluatesAndReports) {
  const Finished finished = Run("evaluate yard --method curvelet,icp --out report --json");
  EXPECT_EQ(finished.status, 0) << finished.err;
  const json report = json::parse(finished.out);
  EXPECT_EQ(report["dataset"], "yard");
  ASSERT_EQ(report["methods"].size(), 2u);
  EXPECT_EQ(report["methods"][0]["method"], "curvelet");
  EXPECT_EQ(report["methods"][0]["pairs"], 2);
  EXPECT_EQ(report["methods"][0]["ok"], 2);
  EXPECT_EQ(report["methods"][0]["details"].size(), 2u);
  EXPECT_EQ(json::parse(ReadFile(data_->File("report/report.json"))), report);
  EXPECT_THAT(ReadFile(data_->File("report/report.html")), HasSubstr("icp"));
}

TEST_F(CliTest, EveryChangesThePairs) {
  const json report = json::parse(Run("evaluate yard --every 2 --out report2 --json").out);
  ASSERT_EQ(report["methods"][0]["details"].size(), 1u);
  EXPECT_EQ(report["methods"][0]["details"][0]["source"], "0002");
  ExpectRefused("evaluate yard --every 3 --out report3", "no pair");
}

TEST_F(CliTest, AcceptedNegativePairsWouldBeCounted) {
  const json report = json::parse(Run("evaluate apart --out report4 --json").out);
  EXPECT_EQ(report["methods"][0]["negatives"], 3);
  EXPECT_EQ(report["methods"][0]["accepted_wrong"], 0);
}

TEST_F(CliTest, TheOldNamesOfNegativePairsWorkWithANotice) {
  const Finished made = Run("simulate --preset strangers --scans 3 --seed 5 --out apart_by_old_name");
  EXPECT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(made.err, HasSubstr("negatives"));
  const std::string folder = data_->File("apart_by_old_name/");
  EXPECT_EQ(ReadFile(folder + "negatives.txt"), ReadFile(data_->File("apart/negatives.txt")));
  std::filesystem::rename(folder + "negatives.txt", folder + "strangers.txt");
  const Finished evaluated = Run("evaluate apart_by_old_name --out report5 --json");
  EXPECT_EQ(evaluated.status, 0) << evaluated.err;
  EXPECT_THAT(evaluated.err, HasSubstr("negatives.txt"));
  EXPECT_EQ(json::parse(evaluated.out)["methods"][0]["negatives"], 3);
}

TEST_F(CliTest, InspectDrawsEveryStage) {
  const Finished finished = Run("inspect " + Yard(0) + " --out pictures --json");
  ASSERT_EQ(finished.status, 0) << finished.err;
  const json result = json::parse(finished.out);
  std::vector<std::string> names = result["pictures"];
  EXPECT_THAT(names, ::testing::IsSupersetOf({"range.png", "bearing_angle.png", "elevation.png", "occupancy.png",
                                              "coefficients.png", "range_doc_2.png", "elevation_doc_3.png",
                                              "range_keypoints.png", "elevation_keypoints.png"}));
  for (const std::string& name : names) {
    EXPECT_THAT(ReadFile(data_->File("pictures/" + name)).substr(0, 8), HasSubstr("PNG")) << name;
  }
  EXPECT_GT(result["num_keypoints"]["elevation"], 100);
  ExpectRefused("inspect absent.pcd --out pictures", "absent.pcd");
  ExpectRefused("inspect " + Yard(0), "--out");
  ExpectRefused("inspect " + Yard(0) + " --out pictures --gravity 0,0", "0,0");
}

TEST_F(CliTest, FoldersThatAreNoDataSetAreNamed) {
  std::filesystem::create_directories(data_->File("nothing"));
  ExpectRefused("evaluate absent --out r", "absent");
  ExpectRefused("evaluate nothing --out r", "nothing");
  ExpectRefused("evaluate " + Yard(0) + " --out r", "0000.pcd");
}

TEST_F(CliTest, AnInterruptEndsItWithStatusOne) {
  const Finished finished =
      Run("simulate --preset mars-dome --seed 2 --out long", "timeout --preserve-status -s INT 1.5");
  EXPECT_EQ(finished.status, 1) << finished.err;
  EXPECT_THAT(finished.out, IsEmpty());
  EXPECT_THAT(finished.err, Not(IsEmpty()));
}

}  // namespace
}  // namespace curvereg
