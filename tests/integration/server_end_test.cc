// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A server that stops while it has more work than its grace time allows for.
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include <grpcpp/create_channel.h>
#include <gtest/gtest.h>

#include "curvereg/v1/registration_service.grpc.pb.h"
#include "tests/testing/server_process.h"
#include "tests/testing/simulated.h"
#include "tests/testing/test_data.h"
#include "wire/error.h"
#include "wire/point_codec.h"
#include "wire/status_mapping.h"

namespace curvereg {
namespace {

using Clock = std::chrono::steady_clock;

TEST(ServerEndTest, WhatStillRunsIsToldWhy) {
  const testing::TemporaryFolder folder;
  testing::ServerProcess server(
      CURVEREG_SERVER_EXECUTABLE, folder.path(),
      {"--grace-seconds", "1", "--drain-delay-ms", "900", "--limits-max-concurrent-registrations", "1"});
  ASSERT_NE(server.port(), 0);
  const testing::ScanPairWithTruth pair = testing::PairOf("mars-yard-sim", 1, 0);
  v1::RegisterScansRequest request;
  *request.mutable_source()->mutable_inline_scan() = *wire::EncodeScan(pair.source);
  *request.mutable_target()->mutable_inline_scan() = *wire::EncodeScan(pair.target);
  request.mutable_options()->set_method(v1::METHOD_PAPER);
  const auto stub =
      v1::RegistrationService::NewStub(grpc::CreateChannel(server.target(), grpc::InsecureChannelCredentials()));
  std::atomic<Clock::time_point> last_begin = Clock::time_point::max();
  std::array<absl::Status, 8> ends;
  std::vector<std::jthread> callers;
  for (absl::Status& end : ends) {
    callers.emplace_back([&] {
      while (end.ok() && Clock::now() < last_begin.load()) {
        grpc::ClientContext context;
        v1::RegisterScansResponse response;
        end = wire::FromGrpcStatus(stub->RegisterScans(&context, request, &response));
      }
    });
  }
  const Clock::time_point give_up = Clock::now() + std::chrono::seconds(20);
  while (server.Get("/metrics").find("curvereg_queue_length 7") == std::string::npos) {
    ASSERT_LT(Clock::now(), give_up);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  last_begin = Clock::now() + std::chrono::milliseconds(850);  // right before the calls are stopped
  EXPECT_EQ(server.Terminate(), 0);
  callers.clear();
  for (const absl::Status& end : ends) {
    if (end.ok()) continue;
    EXPECT_EQ(wire::ReasonOf(end), v1::ERROR_REASON_NOT_SERVING) << end;
  }
  EXPECT_TRUE(std::any_of(ends.begin(), ends.end(), [](const absl::Status& end) {
    return end.message() == "the server stopped before the call was done";  // not only refused
  }));
}

}  // namespace
}  // namespace curvereg
