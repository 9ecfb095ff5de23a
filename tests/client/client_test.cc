// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/client.h"

#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/client/scripted_server.h"
#include "tests/testing/scenes.h"
#include "wire/conversion.h"
#include "wire/error.h"
#include "wire/point_codec.h"
#include "wire/status_mapping.h"

namespace curvereg {
namespace {

using std::chrono::milliseconds;
using testing::ConnectTo;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::QuickOptions;
using testing::Script;
using testing::ScriptedServer;
using Clock = std::chrono::steady_clock;

grpc::Status Refusal(v1::ErrorReason reason, milliseconds delay = milliseconds(0)) {
  const absl::Status error = wire::MakeError(reason, "refused");
  return wire::ToGrpcStatus(delay.count() > 0 ? wire::WithRetryDelay(error, delay) : error, "request-1");
}

RegistrationResult KnownResult() {
  RegistrationResult result;
  result.has_pose = true;
  result.T_target_source.translation() = Eigen::Vector3d(1, 2, 3);
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
  EXPECT_EQ(result->T_target_source.translation(), Eigen::Vector3d(1, 2, 3));
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

TEST(ClientTest, GivesUpAfterTheLastAttempt) {
  std::atomic<int> calls = 0;
  const ScriptedServer server(WithRegistration([&](auto&, const auto&, auto&) {
    ++calls;
    return Refusal(v1::ERROR_REASON_NOT_SERVING);
  }));
  ClientOptions options = QuickOptions();
  options.retry.max_attempts = 4;
  const auto result =
      ConnectTo(server.target(), options)->RegisterScans(std::string("scans/a"), std::string("scans/b"));
  EXPECT_TRUE(absl::IsUnavailable(result.status())) << result.status();
  EXPECT_EQ(ErrorReasonName(result.status()), "NOT_SERVING");
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

TEST(ClientTest, ListsAllPages) {
  std::vector<std::string> tokens;
  Script script;
  script.list_scans = [&](auto&, const auto& request, auto& response) {
    tokens.push_back(request.page_token());
    const std::string page = std::to_string(tokens.size());
    response.add_scans()->set_name("scans/" + page);
    if (tokens.size() < 3) response.set_next_page_token(page);
    return grpc::Status::OK;
  };
  const ScriptedServer server(script);
  const auto scans = ConnectTo(server.target())->ListScans();
  ASSERT_TRUE(scans.ok()) << scans.status();
  ASSERT_EQ(scans->size(), 3U);
  EXPECT_EQ((*scans)[2].name, "scans/3");
  EXPECT_THAT(tokens, ElementsAre("", "1", "2"));
}

TEST(ClientTest, DoesNotTurnPagesForEver) {
  Script script;
  script.list_scans = [](auto&, const auto&, auto& response) {
    response.set_next_page_token("again");
    return grpc::Status::OK;
  };
  const ScriptedServer server(script);
  EXPECT_TRUE(absl::IsInternal(ConnectTo(server.target())->ListScans().status()));
}

TEST(ClientTest, ADeletionWhoseAnswerWasLostIsADeletion) {
  std::atomic<int> calls = 0;
  Script script;
  script.delete_scan = [&](auto&, const auto&, auto&) {
    return ++calls == 1 ? grpc::Status(grpc::UNAVAILABLE, "lost") : Refusal(v1::ERROR_REASON_SCAN_NOT_FOUND);
  };
  const ScriptedServer server(script);
  const auto client = ConnectTo(server.target());
  EXPECT_TRUE(client->DeleteScan("scans/a").ok());
  EXPECT_TRUE(absl::IsNotFound(client->DeleteScan("scans/a")));
}

TEST(ClientTest, ReadsAScansDescription) {
  Script script;
  script.get_scan = [](auto&, const auto& request, auto& response) {
    v1::Scan& scan = *response.mutable_scan();
    scan.set_name(request.name());
    scan.set_payload_bytes(1234);
    scan.set_finite_point_count(99);
    scan.set_content_digest("cd");
    scan.mutable_header()->set_point_count(100);
    scan.mutable_header()->set_frame_id("mast");
    scan.mutable_header()->set_encoding(v1::POINT_ENCODING_QUANTIZED_ZSTD);
    scan.mutable_header()->mutable_quantization()->set_max_error_m(0.002);
    scan.mutable_create_time()->set_seconds(1'700'000'000);
    return grpc::Status::OK;
  };
  const ScriptedServer server(script);
  const auto scan = ConnectTo(server.target())->GetScan("scans/x");
  ASSERT_TRUE(scan.ok()) << scan.status();
  EXPECT_EQ(scan->name, "scans/x");
  EXPECT_EQ(scan->payload_bytes, 1234U);
  EXPECT_EQ(scan->num_points, 100U);
  EXPECT_EQ(scan->num_finite_points, 99U);
  EXPECT_EQ(scan->content_digest, "cd");
  EXPECT_EQ(scan->frame_id, "mast");
  EXPECT_EQ(scan->encoding, "quantized");
  EXPECT_EQ(scan->max_error_m, 0.002);
  EXPECT_EQ(std::chrono::system_clock::to_time_t(scan->create_time), 1'700'000'000);
}

TEST(ClientTest, ReadsPictures) {
  Script script;
  script.render_scan = [](auto&, const auto& request, auto& response) {
    v1::RenderedPicture& picture = *response.add_pictures();
    picture.set_name(request.scan().name());
    picture.set_png("png");
    response.set_point_count(3);
    v1::KeypointCount& count = *response.add_keypoint_counts();
    count.set_view("range");
    count.set_count(17);
    return grpc::Status::OK;
  };
  const ScriptedServer server(script);
  const auto client = ConnectTo(server.target());
  const auto pictures = client->RenderScan(std::string("scans/x"));
  ASSERT_TRUE(pictures.ok()) << pictures.status();
  ASSERT_EQ(pictures->pictures.size(), 1U);
  EXPECT_EQ(pictures->pictures[0].name, "scans/x");
  EXPECT_EQ(pictures->pictures[0].png, "png");
  EXPECT_EQ(pictures->num_points, 3U);
  EXPECT_THAT(pictures->num_keypoints, ElementsAre(std::pair<std::string, int>("range", 17)));
  EXPECT_TRUE(absl::IsInvalidArgument(client->RenderScan(std::string("scans/x"), -1).status()));
}

TEST(ErrorReasonNameTest, IsEmptyWithoutAReasonOfOurs) {
  EXPECT_EQ(ErrorReasonName(absl::OkStatus()), "");
  EXPECT_EQ(ErrorReasonName(absl::UnavailableError("x")), "");
  EXPECT_EQ(ErrorReasonName(wire::MakeError(v1::ERROR_REASON_QUEUE_FULL, "x")), "QUEUE_FULL");
}

}  // namespace
}  // namespace curvereg
