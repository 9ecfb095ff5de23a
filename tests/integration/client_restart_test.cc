// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Clients with the default options outlast a restart, however long the server takes to finish its work.
#include <algorithm>
#include <chrono>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/client.h"
#include "tests/testing/matchers.h"
#include "tests/testing/server_process.h"
#include "tests/testing/simulated.h"
#include "tests/testing/test_data.h"

namespace curvereg {
namespace {

using testing::IsOk;
using testing::ServerProcess;

// Registrations of scans that do not match, which takes longest, waiting for each other for about `time`.
class LongWork {
 public:
  LongWork(const ServerProcess& server, std::chrono::duration<double> time)
      : client_(Client::Connect(server.target())) {
    EXPECT_THAT(client_, IsOk());
    const testing::ScanPairWithTruth pair = testing::PairOf("negatives", 1, 0);
    source_ = (*client_)->UploadScan(pair.source)->scan.name;
    target_ = (*client_)->UploadScan(pair.target)->scan.name;
    Register();  // prepares the scans
    const auto start = std::chrono::steady_clock::now();
    Register();
    const std::chrono::duration<double> once = std::chrono::steady_clock::now() - start;
    const int count = std::min(kMaxCalls, 1 + static_cast<int>(time / once));
    for (int i = 0; i < count; ++i) callers_.emplace_back([this] { Register(); });
  }

  static constexpr int kMaxCalls = 200;

 private:
  void Register() {
    RegistrationOptions options;
    options.num_threads = 1;
    EXPECT_THAT((*client_)->RegisterScans(source_, target_, options), IsOk());
  }

  const absl::StatusOr<std::unique_ptr<Client>> client_;
  std::string source_;
  std::string target_;
  std::vector<std::jthread> callers_;
};

TEST(ClientRestartTest, ClientsOutlastAServerThatDrainsForLong) {
  // Longer than the attempts of a call would last: 3.6 s at most.
  constexpr std::chrono::seconds kDraining(6);
  const std::string queue_length = std::to_string(LongWork::kMaxCalls);
  const testing::TemporaryFolder folder;
  ServerProcess server(CURVEREG_SERVER_EXECUTABLE, folder.path(),
                       {"--grace-seconds", "60", "--limits-max-concurrent-registrations", "1",
                        "--limits-max-queue-length", queue_length, "--limits-max-queue-per-client", queue_length});
  const auto log = [&folder] {
    std::ostringstream text;
    text << std::ifstream(folder.File("server.log")).rdbuf();
    return text.str();
  };
  ASSERT_NE(server.port(), 0) << log();
  const testing::ScanPairWithTruth pair = testing::PairOf("sparse", 1, 0);
  const LongWork work(server, kDraining);
  while (server.Get("/metrics").find("curvereg_registrations_running 1") == std::string::npos) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  const std::string target = server.target();
  ClientOptions once;
  once.retry.max_attempts = 1;
  const auto prober = Client::Connect(target, once);
  ASSERT_THAT(prober, IsOk());
  const auto start = std::chrono::steady_clock::now();
  int exit_status = -1;
  std::jthread stopper([&] { exit_status = server.Terminate(std::chrono::seconds(70)); });
  while ((*prober)->ListScans().ok()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  ASSERT_EQ(ErrorReasonName((*prober)->ListScans().status()), "NOT_SERVING");

  const auto with_default_options = [&target](const std::function<absl::Status(Client&)>& call) {
    return std::jthread([&target, call] {
      const auto client = Client::Connect(target);
      ASSERT_THAT(client, IsOk());
      EXPECT_THAT(call(**client), IsOk());
    });
  };
  const std::jthread lists = with_default_options([](Client& client) { return client.ListScans().status(); });
  const std::jthread registers = with_default_options([&pair](Client& client) {
    return client.RegisterScans(std::cref(pair.source), std::cref(pair.target)).status();
  });
  const std::jthread uploads =
      with_default_options([&pair](Client& client) { return client.UploadScan(pair.source).status(); });
  stopper.join();
  EXPECT_EQ(exit_status, 0) << log();
  EXPECT_GT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5)) << "too little work for this test";
  ASSERT_TRUE(server.Restart()) << log();
}

}  // namespace
}  // namespace curvereg
