// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/client.h"

#include <atomic>
#include <chrono>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/traverses.h"
#include "tests/client/scripted_server.h"
#include "tests/testing/scenes.h"
#include "tests/testing/silent_server.h"
#include "wire/error.h"
#include "wire/point_codec.h"
#include "wire/result_conversion.h"

namespace curvereg {
namespace {

using std::chrono::milliseconds;
using testing::ConnectTo;
using testing::QuickOptions;
using testing::Refusal;
using testing::Script;
using testing::ScriptedServer;
using Clock = std::chrono::steady_clock;

RegistrationResult KnownResult() {
  RegistrationResult result;
  result.T_target_source = RigidTransform::Identity();
  result.T_target_source->translation() = Eigen::Vector3d(1, 2, 3);
  result.seed = 7;
  return result;
}

grpc::Status Answer(v1::RegisterScansResponse& response) {
  *response.mutable_result() = wire::ToWire(KnownResult());
  return grpc::Status::OK;
}

Script WithRegistration(decltype(Script::register_scans) function) {
  Script script;
  script.register_scans = std::move(function);
  return script;
}

TEST(ClientTest, SendsAnInlineScanAndANameAndReadsTheResult) {
  const Scan scan{testing::PatchPoints({}, 500, 3), Eigen::Vector3d(0, 0, -1)};
  v1::RegisterScansRequest received;
  const ScriptedServer server(WithRegistration([&](auto&, const auto& request, auto& response) {
    received = request;
    return Answer(response);
  }));
  RegistrationOptions options;
  options.seed = 5;
  options.time_budget_s = 2.5;
  const auto result = ConnectTo(server.target())->RegisterScans(std::cref(scan), std::string("scans/b"), options);
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_EQ(result->T_target_source->translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(result->seed, 7U);
  EXPECT_EQ(received.target().name(), "scans/b");
  EXPECT_EQ(received.options().seed(), 5U);
  EXPECT_EQ(received.options().time_budget().seconds(), 2);
  const auto& cloud = received.source().inline_scan();
  const auto decoded = wire::DecodeScan(cloud.header(), cloud.data(), {});
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  EXPECT_EQ(decoded->points, scan.points);
}

TEST(ClientTest, ComesBackAfterUnavailable) {
  std::atomic<int> calls = 0;
  const ScriptedServer server(WithRegistration([&](auto&, const auto&, auto& response) {
    return ++calls < 3 ? Refusal(v1::ERROR_REASON_NOT_SERVING) : Answer(response);
  }));
  const auto result = ConnectTo(server.target())->RegisterScans(std::string("scans/a"), std::string("scans/b"));
  EXPECT_TRUE(result.ok()) << result.status();
  EXPECT_EQ(calls, 3);
}

TEST(ClientTest, OutlastsAServerThatStopsSlowly) {
  std::atomic<int> calls = 0;
  const ScriptedServer server(WithRegistration([&](auto&, const auto&, auto& response) {
    return ++calls < 20 ? Refusal(v1::ERROR_REASON_NOT_SERVING) : Answer(response);
  }));
  const auto result = ConnectTo(server.target())->RegisterScans(std::string("scans/a"), std::string("scans/b"));
  EXPECT_TRUE(result.ok()) << result.status();
  EXPECT_EQ(calls, 20) << "far more than the attempts of a call, which are five";
}

TEST(ClientTest, ACallTimeoutEndsRefusals) {
  const ScriptedServer server(
      WithRegistration([](auto&, const auto&, auto&) { return Refusal(v1::ERROR_REASON_NOT_SERVING); }));
  ClientOptions options = QuickOptions();
  // Two attempts, the second 0.8 to 1.2 s after the first, so that time never runs out amid one.
  options.retry.initial_backoff = options.retry.max_backoff = milliseconds(1000);
  options.call_timeout = milliseconds(1500);
  const auto client = ConnectTo(server.target(), options);
  const Clock::time_point start = Clock::now();
  const auto result = client->RegisterScans(std::string("scans/a"), std::string("scans/b"));
  EXPECT_EQ(ErrorReasonName(result.status()), "NOT_SERVING") << result.status();
  EXPECT_LT(Clock::now() - start, milliseconds(3000));
}

TEST(ClientTest, GivesUpAfterTheLastAttempt) {
  std::atomic<int> calls = 0;
  const ScriptedServer server(WithRegistration([&](auto&, const auto&, auto&) {
    ++calls;
    return Refusal(v1::ERROR_REASON_QUEUE_FULL, milliseconds(1));
  }));
  ClientOptions options = QuickOptions();
  options.retry.max_attempts = 4;
  const auto result =
      ConnectTo(server.target(), options)->RegisterScans(std::string("scans/a"), std::string("scans/b"));
  EXPECT_TRUE(absl::IsResourceExhausted(result.status())) << result.status();
  EXPECT_EQ(ErrorReasonName(result.status()), "QUEUE_FULL");
  EXPECT_EQ(calls, 4);
}

TEST(ClientTest, WaitsAsLongAsTheServerAsks) {
  std::atomic<int> calls = 0;
  const ScriptedServer server(WithRegistration([&](auto&, const auto&, auto& response) {
    return ++calls < 2 ? Refusal(v1::ERROR_REASON_QUEUE_FULL, milliseconds(300)) : Answer(response);
  }));
  const auto client = ConnectTo(server.target());
  const Clock::time_point start = Clock::now();
  EXPECT_TRUE(client->RegisterScans(std::string("scans/a"), std::string("scans/b")).ok());
  EXPECT_GE(Clock::now() - start, milliseconds(300));
  EXPECT_EQ(calls, 2);
}

TEST(ClientTest, UnderstandsPushbackInTheTrailer) {
  std::atomic<int> calls = 0;
  const ScriptedServer server(WithRegistration([&](auto& context, const auto&, auto& response) {
    if (++calls == 2) return Answer(response);
    context.AddTrailingMetadata("grpc-retry-pushback-ms", calls == 1 ? "250" : "-1");
    return grpc::Status(grpc::RESOURCE_EXHAUSTED, "busy");
  }));
  const auto client = ConnectTo(server.target());
  const Clock::time_point start = Clock::now();
  EXPECT_TRUE(client->RegisterScans(std::string("scans/a"), std::string("scans/b")).ok());
  EXPECT_GE(Clock::now() - start, milliseconds(250));
  // A negative number: do not come back.
  const auto refused = client->RegisterScans(std::string("scans/a"), std::string("scans/b"));
  EXPECT_TRUE(absl::IsResourceExhausted(refused.status())) << refused.status();
  EXPECT_EQ(calls, 3);
}

TEST(ClientTest, DoesNotRepeatWhatCannotHelp) {
  for (const v1::ErrorReason reason :
       {v1::ERROR_REASON_STORAGE_FULL, v1::ERROR_REASON_WRITER_REPLACED, v1::ERROR_REASON_SCAN_NOT_FOUND,
        v1::ERROR_REASON_INTERNAL, v1::ERROR_REASON_UNAUTHENTICATED}) {
    std::atomic<int> calls = 0;
    const ScriptedServer server(WithRegistration([&](auto&, const auto&, auto&) {
      ++calls;
      return Refusal(reason);
    }));
    const auto result = ConnectTo(server.target())->RegisterScans(std::string("scans/a"), std::string("scans/b"));
    EXPECT_EQ(ErrorReasonName(result.status()), wire::ReasonName(reason)) << result.status();
    EXPECT_EQ(result.status().code(), wire::ReasonCode(reason));
    EXPECT_EQ(calls, 1) << wire::ReasonName(reason);
  }
}

TEST(ClientTest, KeepsToTheCallTimeout) {
  const ScriptedServer server(WithRegistration([&](auto& context, const auto&, auto&) {
    while (!context.IsCancelled()) std::this_thread::sleep_for(milliseconds(5));
    return grpc::Status::CANCELLED;
  }));
  ClientOptions options = QuickOptions();
  options.call_timeout = milliseconds(200);
  const auto client = ConnectTo(server.target(), options);
  const Clock::time_point start = Clock::now();
  const auto result = client->RegisterScans(std::string("scans/a"), std::string("scans/b"));
  EXPECT_TRUE(absl::IsDeadlineExceeded(result.status())) << result.status();
  EXPECT_GE(Clock::now() - start, milliseconds(190));
  EXPECT_LT(Clock::now() - start, milliseconds(3000));
}

TEST(ClientTest, CancellationReachesTheServer) {
  std::atomic<bool> running = false;
  std::atomic<bool> cancelled = false;
  const ScriptedServer server(WithRegistration([&](auto& context, const auto&, auto&) {
    running = true;
    while (!context.IsCancelled()) std::this_thread::sleep_for(milliseconds(5));
    cancelled = true;
    return grpc::Status::CANCELLED;
  }));
  const auto client = ConnectTo(server.target());
  std::stop_source source;
  const std::jthread canceller([&] {
    while (!running) std::this_thread::sleep_for(milliseconds(1));
    source.request_stop();
  });
  RegistrationOptions options;
  options.cancellation = source.get_token();
  const auto result = client->RegisterScans(std::string("scans/a"), std::string("scans/b"), options);
  EXPECT_TRUE(absl::IsCancelled(result.status())) << result.status();
  for (int i = 0; i < 1000 && !cancelled; ++i) std::this_thread::sleep_for(milliseconds(5));
  EXPECT_TRUE(cancelled);
}

TEST(ClientTest, UnaryCallsEndWhenTheCallerSays) {
  const testing::SilentServer server;
  ClientOptions options = QuickOptions();
  options.call_timeout = std::chrono::seconds(60);
  const auto client = ConnectTo(server.target(), options);
  const Clock::time_point start = Clock::now();
  std::stop_source cancelled;
  cancelled.request_stop();
  const Stop at_once{cancelled.get_token(), std::nullopt};
  const Stop soon{{}, start + milliseconds(200)};
  EXPECT_TRUE(absl::IsCancelled(client->Status(at_once).status()));
  EXPECT_TRUE(absl::IsCancelled(client->GetScan("scans/a", at_once).status()));
  EXPECT_TRUE(absl::IsCancelled(client->ListScans(at_once).status()));
  EXPECT_TRUE(absl::IsCancelled(client->DeleteScan("scans/a", at_once)));
  EXPECT_TRUE(absl::IsCancelled(client->traverses().Get("traverses/a", at_once).status()));
  EXPECT_TRUE(absl::IsDeadlineExceeded(client->DeleteScan("scans/a", soon)));
  EXPECT_TRUE(absl::IsDeadlineExceeded(client->traverses().Delete("traverses/a", soon)));
  EXPECT_LT(Clock::now() - start, std::chrono::seconds(20));
}

TEST(ClientTest, ConnectingEndsWhenTheCallerSays) {
  ClientOptions options = QuickOptions();
  options.connect_timeout = std::chrono::seconds(60);
  std::stop_source cancellation;
  const std::jthread user([&cancellation] {
    std::this_thread::sleep_for(milliseconds(100));
    cancellation.request_stop();
  });
  const Clock::time_point start = Clock::now();
  EXPECT_TRUE(absl::IsCancelled(Client::Connect("127.0.0.1:1", options, cancellation.get_token()).status()));
  EXPECT_LT(Clock::now() - start, std::chrono::seconds(20));
}

TEST(ClientTest, SendsTheTokenAsBearer) {
  std::string header;
  const ScriptedServer server(WithRegistration([&](auto& context, const auto&, auto& response) {
    const auto found = context.client_metadata().find("authorization");
    if (found != context.client_metadata().end()) header.assign(found->second.data(), found->second.size());
    return Answer(response);
  }));
  ClientOptions options = QuickOptions();
  options.token = "abc";
  EXPECT_TRUE(ConnectTo(server.target(), options)->RegisterScans(std::string("scans/a"), std::string("scans/b")).ok());
  EXPECT_EQ(header, "Bearer abc");
}

TEST(ClientTest, NamesTheSideThatCannotBeSent) {
  const ScriptedServer server({});
  const auto client = ConnectTo(server.target());
  const auto result = client->RegisterScans(std::string("scans/a"), std::string());
  EXPECT_TRUE(absl::IsInvalidArgument(result.status())) << result.status();
}

TEST(ClientTest, RefusesAResultThatMakesNoSense) {
  const ScriptedServer server(WithRegistration([&](auto&, const auto&, auto& response) {
    Answer(response);
    response.mutable_result()->mutable_t_target_source()->mutable_rotation()->set_w(100.0);
    return grpc::Status::OK;
  }));
  const auto result = ConnectTo(server.target())->RegisterScans(std::string("scans/a"), std::string("scans/b"));
  EXPECT_TRUE(absl::IsInternal(result.status())) << result.status();
}

}  // namespace
}  // namespace curvereg
