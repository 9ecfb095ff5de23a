// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A real server from start to stop: readiness, metrics, draining, restart under a client, refusals at start-up.
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/client.h"
#include "tests/testing/matchers.h"
#include "tests/testing/server_process.h"
#include "tests/testing/simulated.h"
#include "tests/testing/test_data.h"

namespace curvereg {
namespace {

using ::testing::HasSubstr;
using testing::IsNear;
using testing::IsOk;
using testing::ServerProcess;

class ServerLifecycleTest : public ::testing::Test {
 protected:
  ServerProcess& Start(const std::vector<std::string>& arguments = {}) {
    server_ = std::make_unique<ServerProcess>(CURVEREG_SERVER_EXECUTABLE, folder_.path(), arguments);
    EXPECT_NE(server_->port(), 0) << Log();
    return *server_;
  }
  std::string Log() const {
    std::ostringstream text;
    text << std::ifstream(folder_.File("server.log")).rdbuf();
    return text.str();
  }

  testing::TemporaryFolder folder_;
  std::unique_ptr<ServerProcess> server_;
};

TEST_F(ServerLifecycleTest, RegistersInlineAndStoredScansAlike) {
  const ServerProcess& server = Start();
  const testing::ScanPairWithTruth pair = testing::PairOf("sparse", 1, 0);
  const auto client = Client::Connect(server.target());
  ASSERT_THAT(client, IsOk());
  const auto inline_result = (*client)->RegisterScans(std::cref(pair.source), std::cref(pair.target));
  ASSERT_THAT(inline_result, IsOk());
  EXPECT_THAT(inline_result->T_target_source, IsNear(pair.T_target_source, 0.05, 0.005));

  TransferOptions lossless;
  lossless.encoding.kind = TransferEncoding::Kind::kLossless;
  const auto source = (*client)->UploadScan(pair.source, lossless);
  const auto target = (*client)->UploadScan(pair.target, lossless);
  ASSERT_THAT(source, IsOk());
  ASSERT_THAT(target, IsOk());
  const auto stored_result = (*client)->RegisterScans(source->scan.name, target->scan.name);
  ASSERT_THAT(stored_result, IsOk());
  EXPECT_EQ(stored_result->T_target_source->matrix(), inline_result->T_target_source->matrix());
  EXPECT_EQ(stored_result->source_digest, inline_result->source_digest);
  EXPECT_EQ(stored_result->evidence.num_inliers, inline_result->evidence.num_inliers);
}

TEST_F(ServerLifecycleTest, TellsHowItIs) {
  const ServerProcess& server = Start();
  int status = 0;
  server.Get("/livez", &status);
  EXPECT_EQ(status, 200);
  server.Get("/readyz", &status);
  EXPECT_EQ(status, 200);
  EXPECT_THAT(server.Get("/metrics"), HasSubstr("curvereg_build_info"));
  const auto client = Client::Connect(server.target());
  ASSERT_THAT(client, IsOk());
  const auto told = (*client)->Status();
  ASSERT_THAT(told, IsOk());
  EXPECT_TRUE(told->serving);
  EXPECT_GE(told->services.size(), 2U);
  EXPECT_FALSE(told->limits.empty());
}

TEST_F(ServerLifecycleTest, SigtermEndsAnIdleServerSoonWithStatusZero) {
  ServerProcess& server = Start({"--grace-seconds", "20"});
  const auto client = Client::Connect(server.target());  // an idle connection must not hold it up
  ASSERT_THAT(client, IsOk());
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(server.Terminate(), 0) << Log();
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
}

TEST_F(ServerLifecycleTest, SigtermLetsRunningWorkFinish) {
  ServerProcess& server = Start({"--grace-seconds", "30"});
  const testing::ScanPairWithTruth pair = testing::PairOf("mars-yard-sim", 1, 0);
  const auto client = Client::Connect(server.target());
  ASSERT_THAT(client, IsOk());
  RegistrationOptions paper;  // about a second of work
  paper.method = Method::kPaper;
  absl::StatusOr<RegistrationResult> result;
  std::atomic<bool> answered = false;
  std::jthread caller([&] {
    result = (*client)->RegisterScans(std::cref(pair.source), std::cref(pair.target), paper);
    answered = true;
  });
  while (server.Get("/metrics").find("curvereg_registrations_running 1") == std::string::npos) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    if (answered) break;  // faster than we looked
  }
  EXPECT_EQ(server.Terminate(), 0) << Log();
  caller.join();
  EXPECT_THAT(result, IsOk());
}

TEST_F(ServerLifecycleTest, AClientWithRetriesSeesNoFailureDuringRestarts) {
  ServerProcess& server = Start({"--drain-delay-ms", "50"});
  const testing::ScanPairWithTruth pair = testing::PairOf("sparse", 1, 0);
  ClientOptions options;
  options.retry.max_backoff = std::chrono::milliseconds(500);
  const auto client = Client::Connect(server.target(), options);
  ASSERT_THAT(client, IsOk());
  std::atomic<int> num_answers = 0, num_failures = 0;
  std::string first_failure;
  std::jthread caller([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      const auto result = (*client)->RegisterScans(std::cref(pair.source), std::cref(pair.target));
      if (result.ok()) {
        ++num_answers;
      } else if (num_failures++ == 0) {
        first_failure = result.status().ToString();
      }
    }
  });
  for (int restart = 0; restart < 3; ++restart) {
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
    EXPECT_EQ(server.Terminate(), 0) << Log();
    ASSERT_TRUE(server.Restart()) << Log();
  }
  const int before = num_answers;
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (num_answers == before && std::chrono::steady_clock::now() < give_up) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  caller.request_stop();
  caller.join();
  EXPECT_GT(num_answers, before) << "it goes on after the last restart";
  EXPECT_EQ(num_failures, 0) << first_failure;
}

TEST_F(ServerLifecycleTest, ASecondServerMayNotUseTheSameFolder) {
  Start();
  const ServerProcess second(CURVEREG_SERVER_EXECUTABLE, folder_.path(), {});
  EXPECT_EQ(second.port(), 0);
  EXPECT_THAT(Log(), HasSubstr("data"));
}

TEST_F(ServerLifecycleTest, ADamagedStoreIsFoundAndSaid) {
  {
    const ServerProcess& server = Start();
    const auto client = Client::Connect(server.target());
    ASSERT_THAT(client, IsOk());
    ASSERT_THAT((*client)->UploadScan(testing::PairOf("sparse", 0, 0).source), IsOk());
    ASSERT_EQ(server_->Terminate(), 0);
  }
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.File("data"))) {
    if (!entry.is_regular_file() || entry.path().extension() != ".db") continue;
    std::fstream file(entry.path(), std::ios::in | std::ios::out | std::ios::binary);
    file.write("this is not a database any more, and nobody must believe it", 59);
  }
  const ServerProcess damaged(CURVEREG_SERVER_EXECUTABLE, folder_.path(), {});
  EXPECT_EQ(damaged.port(), 0);
  EXPECT_THAT(Log(), HasSubstr("damaged"));
}

TEST_F(ServerLifecycleTest, ALostLogOfTheDatabaseIsSaid) {
  ServerProcess& server = Start();
  const auto client = Client::Connect(server.target());
  ASSERT_THAT(client, IsOk());
  ASSERT_THAT((*client)->UploadScan(testing::PairOf("sparse", 0, 0).source), IsOk());
  server.Kill();
  EXPECT_TRUE(server.Restart());
  EXPECT_THAT(server.Get("/metrics"), HasSubstr("\ncurvereg_store_lost_files 0\n"));
  EXPECT_EQ(server.Terminate(), 0);
  EXPECT_TRUE(server.Restart());
  ASSERT_THAT((*Client::Connect(server.target()))->UploadScan(testing::PairOf("sparse", 1, 0).source), IsOk());
  server.Kill();
  ASSERT_TRUE(std::filesystem::remove(folder_.File("data/curvereg.db-wal")));
  EXPECT_THAT(Log(), Not(HasSubstr("files_lost")));
  EXPECT_TRUE(server.Restart());
  EXPECT_THAT(Log(), HasSubstr("files_lost"));
  EXPECT_THAT(server.Get("/metrics"), HasSubstr("\ncurvereg_store_lost_files 1\n"));
}

TEST_F(ServerLifecycleTest, PlainTextOffLoopbackIsRefusedUnlessTold) {
  const ServerProcess server(CURVEREG_SERVER_EXECUTABLE, folder_.path(), {"--listen", "0.0.0.0:0"});
  EXPECT_EQ(server.port(), 0);
  EXPECT_THAT(Log(), HasSubstr("plain"));
}

}  // namespace
}  // namespace curvereg
