// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The built command line against the built server: the same answers as alone, and errors that say what is wrong.
#include <chrono>
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/testing/command_line_test.h"

namespace curvereg {
namespace {

using nlohmann::json;
using testing::Finished;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::ReadFile;

class CliServerTest : public testing::CommandLineTest {
 protected:
  static void SetUpTestSuite() {
    Start({});
    ASSERT_EQ(Alone("simulate --preset sparse --scans 3 --seed 5 --out yard").status, 0);
  }
};

TEST_F(CliServerTest, RegisterGivesTheSameAnswerAsAlone) {
  const Finished alone = Alone("register yard/0001.pcd yard/0000.pcd --json");
  const Finished asking = Asking("register yard/0001.pcd yard/0000.pcd --json");
  EXPECT_EQ(alone.status, 0) << alone.err;
  EXPECT_EQ(asking.status, 0) << asking.err;
  const json a = json::parse(alone.out), b = json::parse(asking.out);
  for (const char* key : {"T_target_source", "accepted", "covariance", "evidence", "source_digest", "options_digest"}) {
    EXPECT_EQ(a[key], b[key]) << key;
  }
}

TEST_F(CliServerTest, TheServerMayBeNamedInTheEnvironment) {
  const Finished finished = Alone("status --json", "CURVEREG_SERVER=" + server_->target());
  EXPECT_EQ(finished.status, 0) << finished.err;
  const json status = json::parse(finished.out);
  EXPECT_EQ(status["serving"], true);
  EXPECT_EQ(status["load"]["registrations_waiting"], 0);
  EXPECT_GT(status["limits"]["max_uploads"], 0);
}

TEST_F(CliServerTest, StatusWorksWithoutAServer) {
  const Finished finished = Alone("status");
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_THAT(finished.out, HasSubstr("curvelet"));
}

TEST_F(CliServerTest, AnUnreachableServerIsStatusFour) {
  const auto start = std::chrono::steady_clock::now();
  const Finished finished = Alone("status --server 127.0.0.1:1 --timeout 2");
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(8)) << "of trying to connect, too";
  EXPECT_EQ(finished.status, 4) << finished.err;
  EXPECT_THAT(finished.out, IsEmpty());
  EXPECT_THAT(finished.err, HasSubstr("127.0.0.1:1"));
  EXPECT_EQ(Alone("register yard/0001.pcd yard/0000.pcd --server 127.0.0.1:1 --timeout 2").status, 4);
}

TEST_F(CliServerTest, ScansGoUpAndComeDownAndRegisterByName) {
  const Finished up = Asking("scans upload yard/0000.pcd yard/0001.pcd --json");
  ASSERT_EQ(up.status, 0) << up.err;
  const json scans = json::parse(up.out)["scans"];
  const std::string target = scans[0]["name"], source = scans[1]["name"];
  EXPECT_THAT(Asking("scans list").out, HasSubstr(target));

  const Finished registered = Asking("register " + source + " " + target + " --json --out-cloud merged.ply");
  EXPECT_EQ(registered.status, 0) << registered.err;
  const Finished alone = Alone("register yard/0001.pcd yard/0000.pcd --json");
  EXPECT_EQ(json::parse(registered.out)["T_target_source"], json::parse(alone.out)["T_target_source"]);
  EXPECT_TRUE(std::filesystem::exists(folder_->File("merged.ply")));

  ASSERT_EQ(Asking("scans download " + target + " --out back.pcd").status, 0);
  const Finished back = Alone("register yard/0001.pcd back.pcd --json");
  EXPECT_EQ(json::parse(back.out)["target_digest"], json::parse(alone.out)["target_digest"]);

  EXPECT_EQ(Asking("scans delete " + source + " " + target).status, 0);
  EXPECT_EQ(Asking("register " + source + " " + target).status, 2);
  EXPECT_EQ(Alone("scans list").status, 2) << "scans are stored on servers";
}

TEST_F(CliServerTest, InspectDrawsTheSamePicturesAsAlone) {
  ASSERT_EQ(Alone("inspect yard/0000.pcd --out alone").status, 0);
  const Finished asking = Asking("inspect yard/0000.pcd --out asked");
  ASSERT_EQ(asking.status, 0) << asking.err;
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_->File("alone"))) {
    ++count;
    const std::string name = entry.path().filename();
    EXPECT_EQ(ReadFile(entry.path()), ReadFile(folder_->File("asked/" + name))) << name;
  }
  EXPECT_GT(count, 5);
}

TEST_F(CliServerTest, EvaluateUsesTheServerAndLeavesNothingThere) {
  const Finished alone = Alone("evaluate yard --out report-alone --json");
  const Finished asking = Asking("evaluate yard --out report-asked --json");
  ASSERT_EQ(alone.status, 0) << alone.err;
  ASSERT_EQ(asking.status, 0) << asking.err;
  const json a = json::parse(alone.out), b = json::parse(asking.out);
  for (const char* figure : {"pairs", "ok", "accepted", "accepted_wrong", "failed_calls", "median_translation_m"}) {
    ASSERT_TRUE(a["methods"][0].contains(figure)) << figure << " " << alone.out;
    EXPECT_EQ(a["methods"][0][figure], b["methods"][0][figure]) << figure;
  }
  EXPECT_THAT(Asking("scans list").out, IsEmpty());
}

TEST_F(CliServerTest, RefusalsAreStatusFour) {
  const testing::TemporaryFolder limited_folder, guarded_folder;
  const testing::ServerProcess limited(CURVEREG_SERVER_EXECUTABLE, limited_folder.path(),
                                       {"--limits-max-scan-points", "100"});
  const std::string tokens = guarded_folder.File("tokens.toml");
  ASSERT_EQ(
      testing::RunIn(guarded_folder.path(), "'" CURVEREG_SERVER_EXECUTABLE "' make-token rover --append-to tokens.toml")
          .status,
      0);
  const testing::ServerProcess guarded(CURVEREG_SERVER_EXECUTABLE, guarded_folder.path(), {"--token-file", tokens});
  for (const testing::ServerProcess* server : {&limited, &guarded}) {
    ASSERT_NE(server->port(), 0);
    const Finished finished = Alone("evaluate yard --out refused --server " + server->target());
    EXPECT_EQ(finished.status, 4) << finished.err;
    EXPECT_THAT(finished.out, IsEmpty());
  }
  const Finished upload = Alone("scans upload yard/0000.pcd yard/0001.pcd --server " + limited.target());
  EXPECT_EQ(upload.status, 4);
  EXPECT_THAT(upload.err, HasSubstr("yard/0000.pcd: "));
}

TEST_F(CliServerTest, FilesAreReadBeforeAServerIsWaitedFor) {
  for (const char* command : {"register absent.pcd yard/0000.pcd", "inspect absent.pcd --out pictures",
                              "scans upload yard/0000.pcd absent.pcd"}) {
    const Finished finished = Alone(std::string(command) + " --server 127.0.0.1:1 --timeout 2");
    EXPECT_EQ(finished.status, 2) << command;
    EXPECT_THAT(finished.err, HasSubstr("absent.pcd")) << command;
  }
}

TEST_F(CliServerTest, SimulateStoresItsScans) {
  ASSERT_EQ(Asking("simulate --preset sparse --scans 2 --seed 9 --out stored").status, 0);
  const Finished list = Asking("scans list --json");
  const json scans = json::parse(list.out)["scans"];
  EXPECT_EQ(scans.size(), 2U);
  for (const json& scan : scans) {
    EXPECT_EQ(Asking("scans delete " + scan["name"].get<std::string>()).status, 0);
  }
}

TEST_F(CliServerTest, WrongTlsArgumentsAreSaid) {
  const Finished no_file = Alone("status --tls-ca nowhere.pem --server " + server_->target());
  EXPECT_EQ(no_file.status, 2);
  EXPECT_THAT(no_file.err, HasSubstr("nowhere.pem"));
  EXPECT_EQ(Asking("status --tls --timeout 2").status, 4) << "the server speaks plain text";
  EXPECT_EQ(Alone("status --server 127.0.0.1:" + std::to_string(server_->port() + 65536)).status, 2);
}

}  // namespace
}  // namespace curvereg
