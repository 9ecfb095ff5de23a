// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/client.h"

#include <atomic>
#include <chrono>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/client/scripted_server.h"
#include "wire/error.h"

namespace curvereg {
namespace {

using testing::ConnectTo;
using ::testing::ElementsAre;
using testing::Refusal;
using testing::Script;
using testing::ScriptedServer;

TEST(ClientAnswersTest, ListsAllPages) {
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

TEST(ClientAnswersTest, DoesNotTurnPagesForEver) {
  Script script;
  script.list_scans = [](auto&, const auto&, auto& response) {
    response.set_next_page_token("again");
    return grpc::Status::OK;
  };
  const ScriptedServer server(script);
  EXPECT_TRUE(absl::IsInternal(ConnectTo(server.target())->ListScans().status()));
}

TEST(ClientAnswersTest, ADeletionWhoseAnswerWasLostIsADeletion) {
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

TEST(ClientAnswersTest, ADeletionThatWasRefusedIsNone) {
  std::atomic<int> calls = 0;
  Script script;
  script.delete_scan = [&](auto&, const auto&, auto&) {
    return Refusal(++calls < 3 ? v1::ERROR_REASON_NOT_SERVING : v1::ERROR_REASON_SCAN_NOT_FOUND);
  };
  const ScriptedServer server(script);
  EXPECT_TRUE(absl::IsNotFound(ConnectTo(server.target())->DeleteScan("scans/a")));
  EXPECT_EQ(calls, 3);
}

TEST(ClientAnswersTest, ReadsAScansDescription) {
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

TEST(ClientAnswersTest, ReadsPictures) {
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
