// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A drive streamed to a whole server, cut by its restart in the middle of a scan; then watched and mapped.
#include <gmock/gmock.h>
#include <grpcpp/create_channel.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "server/server.h"
#include "tests/server/traverses/fake_traverses.h"
#include "tests/server/traverses/stream_server.h"
#include "tests/server/traverses/traverse_world.h"
#include "tests/testing/matchers.h"
#include "wire/geometry_conversion.h"
#include "wire/status_mapping.h"

namespace curvereg::testing {
namespace {

using ::testing::ElementsAre;

constexpr int kNumScans = 5;
constexpr uint64_t kCutAt = 40'000;

class StreamedDrive : public ::testing::Test {
 protected:
  StreamedDrive() {
    config_.listen = "127.0.0.1:0";
    config_.ops_listen = "";
    config_.data_dir = folder_.path();
    config_.drain_delay_ms = 0;
    config_.log.level = "error";
    Start();
    grpc::ClientContext context;
    v1::CreateTraverseRequest request;
    request.set_traverse_id("t");
    v1::CreateTraverseResponse response;
    EXPECT_THAT(wire::FromGrpcStatus(stub_->CreateTraverse(&context, request, &response)), IsOk());
  }

  void Start() {
    server_.reset();
    absl::StatusOr<std::unique_ptr<server::Server>> server = server::Server::Start(config_);
    ASSERT_THAT(server, IsOk());
    server_ = *std::move(server);
    stub_ = v1::TraverseService::NewStub(
        grpc::CreateChannel(absl::StrCat("127.0.0.1:", server_->port()), grpc::InsecureChannelCredentials()));
  }

  void SendScans(StreamClient& client, int first, int end) {
    for (int i = first; i < end; ++i) {
      ASSERT_TRUE(client.SendScan(static_cast<uint64_t>(i), server::DriveCloud(i), kCutAt));
    }
  }

  TemporaryFolder folder_;
  server::ServerConfig config_;
  std::unique_ptr<server::Server> server_;
  std::unique_ptr<v1::TraverseService::Stub> stub_;
};

std::string DownloadMap(v1::TraverseService::Stub& stub, const v1::DownloadMapRequest& request, v1::MapHeader& header) {
  grpc::ClientContext context;
  const auto stream = stub.DownloadMap(&context, request);
  std::string bytes;
  for (v1::DownloadMapResponse response; stream->Read(&response);) {
    if (response.has_header()) header = response.header();
    bytes += response.chunk().data();
  }
  EXPECT_THAT(wire::FromGrpcStatus(stream->Finish()), IsOk());
  return bytes;
}

TEST_F(StreamedDrive, TellsScansApartWhateverTheirDigests) {
  const v1::PointCloud cloud = server::DriveCloud(0);
  StreamClient client(*stub_);
  client.Begin();
  v1::StreamScansRequest header = StreamHeader(0, cloud);
  *header.mutable_header()->mutable_payload_digest() = Sha256(cloud.data());
  client.Send(header);
  client.Send(StreamChunk(cloud, 0, cloud.data().size()));
  ASSERT_TRUE(client.ReceiveComplete(0));
  client.Send(StreamHeader(0, cloud));
  ASSERT_TRUE(client.ReceiveComplete(0)) << "the same, by another digest";
  v1::PointCloud other = cloud;
  other.mutable_data()->front() ^= 1;
  client.Send(StreamHeader(0, other));
  EXPECT_EQ(ReasonText(client.End()), "SEQUENCE_DIFFERS");
}

TEST_F(StreamedDrive, EndsWhenItsTraverseIsDeleted) {
  StreamClient client(*stub_);
  client.Begin();
  SendScans(client, 0, 1);
  ASSERT_TRUE(client.ReceiveResult(0));
  grpc::ClientContext context;
  v1::DeleteTraverseRequest request;
  request.set_name(FakeTraverses::kName);
  v1::DeleteTraverseResponse response;
  EXPECT_THAT(wire::FromGrpcStatus(stub_->DeleteTraverse(&context, request, &response)), IsOk());
  EXPECT_EQ(ReasonText(client.End()), "TRAVERSE_NOT_FOUND");
}

TEST_F(StreamedDrive, IsTrackedThroughARestartOfTheServer) {
  {
    StreamClient client(*stub_);
    client.Begin();
    SendScans(client, 0, 2);
    ASSERT_TRUE(client.ReceiveResult(1));
    client.Send(StreamHeader(2, server::DriveCloud(2)));
    client.Send(StreamChunk(server::DriveCloud(2), 0, kCutAt));
    ASSERT_TRUE(client.ReceiveOffset(2, kCutAt));
    server_->Shutdown(std::chrono::milliseconds(1000));
    EXPECT_EQ(ReasonText(client.End()), "NOT_SERVING");
  }
  Start();
  StreamClient client(*stub_);
  const v1::StreamScansReady ready = client.Begin(1);
  EXPECT_EQ(ready.next_sequence_number(), 2);
  EXPECT_EQ(ready.committed_offset(), kCutAt);
  SendScans(client, 2, kNumScans);
  client.HalfClose();
  EXPECT_THAT(client.End(), IsOk());
  ASSERT_THAT(client.ResultNumbers(), ElementsAre(2, 3, 4));
  const v1::TrajectoryPose& last = client.results().back().pose();
  EXPECT_EQ(last.origin(), v1::POSE_ORIGIN_REGISTERED);
  const absl::StatusOr<RigidTransform> T_segment_sensor = wire::FromWire(last.t_segment_sensor());
  ASSERT_THAT(T_segment_sensor, IsOk());
  const RigidTransform truth = server::DrivePose(0).inverse() * server::DrivePose(kNumScans - 1);
  EXPECT_THAT(*T_segment_sensor, IsNear(truth, 0.1, 0.02));
}

TEST_F(StreamedDrive, IsWatchedAndMapped) {
  StreamClient client(*stub_);
  client.Begin();
  SendScans(client, 0, kNumScans);
  client.HalfClose();
  EXPECT_THAT(client.End(), IsOk());
  {
    grpc::ClientContext context;
    v1::WatchTraverseRequest request;
    request.set_name(FakeTraverses::kName);
    request.set_existing_only(true);
    const auto stream = stub_->WatchTraverse(&context, request);
    uint64_t num_events = 0;
    std::vector<uint64_t> registered;
    for (v1::WatchTraverseResponse event; stream->Read(&event);) {
      EXPECT_EQ(event.event(), num_events++);
      if (event.has_result()) registered.push_back(event.result().sequence_number());
    }
    EXPECT_THAT(wire::FromGrpcStatus(stream->Finish()), IsOk());
    EXPECT_THAT(registered, ElementsAre(0, 1, 2, 3, 4));
  }
  v1::DownloadMapRequest request;
  request.set_name(FakeTraverses::kName);
  v1::MapHeader header;
  const std::string whole = DownloadMap(*stub_, request, header);
  EXPECT_GT(header.cell_count(), 1000);
  EXPECT_EQ(whole.size(), header.payload_bytes());
  EXPECT_EQ(whole.size(), 12 * header.cell_count());
  EXPECT_EQ(Xxh3(whole).value(), header.payload_digest().value());
  request.set_offset(whole.size() / 2);
  request.set_version(header.version());
  v1::MapHeader again;
  EXPECT_EQ(whole.substr(0, whole.size() / 2) + DownloadMap(*stub_, request, again), whole);
  EXPECT_EQ(again.version(), header.version());
}

}  // namespace
}  // namespace curvereg::testing
