// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/traverses/traverse_service.h"

#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include "curvereg/v1/scan_service.grpc.pb.h"
#include "server/server.h"
#include "tests/server/traverses/traverse_world.h"
#include "wire/digest.h"
#include "wire/geometry_conversion.h"
#include "wire/status_mapping.h"

namespace curvereg::server {
namespace {

using testing::IsOk;

// A whole server on a free port.
class TraverseServiceTest : public ::testing::Test {
 protected:
  TraverseServiceTest() { Restart(); }

  void Restart() {
    server_.reset();
    ServerConfig config;
    config.listen = "127.0.0.1:0";
    config.ops_listen = "";
    config.data_dir = folder_.File("data");
    config.drain_delay_ms = 0;
    config.log.level = "error";
    auto server = Server::Start(config);
    ASSERT_THAT(server, IsOk());
    server_ = *std::move(server);
    stub_ = v1::TraverseService::NewStub(server_->InProcessChannel());
    scans_ = v1::ScanService::NewStub(server_->InProcessChannel());
  }

  // Calls one of the stub's methods with one request and one answer.
  template <typename Request, typename Response>
  absl::StatusOr<Response> Call(grpc::Status (v1::TraverseService::Stub::*method)(grpc::ClientContext*, const Request&,
                                                                                  Response*),
                                const Request& request) {
    grpc::ClientContext context;
    Response response;
    const grpc::Status status = (stub_.get()->*method)(&context, request, &response);
    if (!status.ok()) return wire::FromGrpcStatus(status);
    return response;
  }
  absl::StatusOr<v1::CreateTraverseResponse> Create(const std::string& id) {
    v1::CreateTraverseRequest request;
    request.set_traverse_id(id);
    return Call(&v1::TraverseService::Stub::CreateTraverse, request);
  }
  absl::StatusOr<v1::GetTraverseResponse> Get(const std::string& name) {
    v1::GetTraverseRequest request;
    request.set_name(name);
    return Call(&v1::TraverseService::Stub::GetTraverse, request);
  }
  absl::Status Delete(const std::string& name) {
    v1::DeleteTraverseRequest request;
    request.set_name(name);
    return Call(&v1::TraverseService::Stub::DeleteTraverse, request).status();
  }

  // Streams scans [first, end) of the drive and reads until the results of all are there; names of the stored scans.
  std::vector<std::string> Stream(const std::string& name, int first, int end) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::minutes(1));
    const auto stream = stub_->StreamScans(&context);
    v1::StreamScansRequest request;
    request.mutable_start()->set_traverse(name);
    if (first > 0) request.mutable_start()->set_last_result_sequence_number(static_cast<uint64_t>(first) - 1);
    stream->Write(request);
    v1::StreamScansResponse response;
    EXPECT_TRUE(stream->Read(&response));
    EXPECT_EQ(response.ready().next_sequence_number(), static_cast<uint64_t>(first));
    for (int i = first; i < end; ++i) {
      const v1::PointCloud cloud = DriveCloud(i);
      request.Clear();
      *request.mutable_header() = StreamedHeader(static_cast<uint64_t>(i), cloud);
      stream->Write(request);
      request.Clear();
      request.mutable_chunk()->set_data(cloud.data());
      request.mutable_chunk()->set_crc32c(wire::Crc32c(cloud.data()));
      stream->Write(request);
    }
    std::vector<std::string> names;
    for (int num_results = 0; num_results < end - first && stream->Read(&response);) {
      if (response.ack().complete()) names.push_back(response.ack().scan());
      if (!response.has_result()) continue;
      EXPECT_EQ(response.result().sequence_number(), static_cast<uint64_t>(first + num_results));
      ++num_results;
    }
    stream->WritesDone();
    while (stream->Read(&response)) {
    }
    EXPECT_THAT(wire::FromGrpcStatus(stream->Finish()), IsOk());
    return names;
  }

  testing::TemporaryFolder folder_;
  std::unique_ptr<Server> server_;
  std::unique_ptr<v1::TraverseService::Stub> stub_;
  std::unique_ptr<v1::ScanService::Stub> scans_;
};

TEST_F(TraverseServiceTest, ADriveFromBeginToEndAndOverARestart) {
  ASSERT_THAT(Create("drive"), IsOk());
  const std::string name = "traverses/drive";
  const std::vector<std::string> scans = Stream(name, 0, 3);
  ASSERT_EQ(scans.size(), 3U);
  Restart();
  EXPECT_EQ(Stream(name, 3, 5).size(), 2U);
  const auto traverse = Get(name);
  ASSERT_THAT(traverse, IsOk());
  EXPECT_EQ(traverse->traverse().registered_scan_count(), 5U);
  EXPECT_EQ(traverse->traverse().segment_count(), 1U);

  v1::OptimizeTraverseRequest optimize;
  optimize.set_name(name);
  const auto optimized = Call(&v1::TraverseService::Stub::OptimizeTraverse, optimize);
  ASSERT_THAT(optimized, IsOk());
  EXPECT_GE(optimized->link_count(), 4U);

  v1::GetTrajectoryRequest poses;
  poses.set_name(name);
  const auto trajectory = Call(&v1::TraverseService::Stub::GetTrajectory, poses);
  ASSERT_THAT(trajectory, IsOk());
  ASSERT_EQ(trajectory->poses_size(), 5);
  EXPECT_EQ(trajectory->version(), optimized->version());
  EXPECT_THAT(*wire::FromWire(trajectory->poses(4).t_segment_sensor()),
              testing::IsNear(DrivePose(0).inverse() * DrivePose(4), 0.03, 0.01));

  v1::WatchTraverseRequest watch;
  watch.set_name(name);
  watch.set_existing_only(true);
  grpc::ClientContext context;
  const auto events = stub_->WatchTraverse(&context, watch);
  v1::WatchTraverseResponse event;
  uint64_t num_events = 0;
  while (events->Read(&event)) EXPECT_EQ(event.event(), num_events++);
  EXPECT_THAT(wire::FromGrpcStatus(events->Finish()), IsOk());
  EXPECT_GE(num_events, 5U);

  v1::DeleteScanRequest delete_scan;
  delete_scan.set_name(scans.front());
  v1::DeleteScanResponse deleted;
  grpc::ClientContext delete_context;
  EXPECT_THAT(wire::FromGrpcStatus(scans_->DeleteScan(&delete_context, delete_scan, &deleted)),
              HasReason(v1::ERROR_REASON_SCAN_IN_USE));
  EXPECT_THAT(Delete(name), IsOk());
  v1::GetScanRequest get_scan;
  get_scan.set_name(scans.front());
  v1::GetScanResponse scan;
  grpc::ClientContext get_context;
  EXPECT_THAT(wire::FromGrpcStatus(scans_->GetScan(&get_context, get_scan, &scan)),
              HasReason(v1::ERROR_REASON_SCAN_NOT_FOUND));
}

TEST_F(TraverseServiceTest, ErrorsHaveTheirReasons) {
  EXPECT_THAT(Create("Drive"), HasReason(v1::ERROR_REASON_INVALID_FIELD));
  EXPECT_THAT(Get("traverses/none"), HasReason(v1::ERROR_REASON_TRAVERSE_NOT_FOUND));
  EXPECT_THAT(Delete("traverses/none"), HasReason(v1::ERROR_REASON_TRAVERSE_NOT_FOUND));
  v1::OptimizeTraverseRequest optimize;
  optimize.set_name("traverses/none");
  EXPECT_THAT(Call(&v1::TraverseService::Stub::OptimizeTraverse, optimize),
              HasReason(v1::ERROR_REASON_TRAVERSE_NOT_FOUND));
  v1::GetTrajectoryRequest trajectory;
  trajectory.set_name("none");
  EXPECT_THAT(Call(&v1::TraverseService::Stub::GetTrajectory, trajectory), HasReason(v1::ERROR_REASON_INVALID_FIELD));
  v1::ListTraversesRequest list;
  list.set_page_token("x");
  EXPECT_THAT(Call(&v1::TraverseService::Stub::ListTraverses, list), HasReason(v1::ERROR_REASON_INVALID_FIELD));
  list.clear_page_token();
  EXPECT_THAT(Call(&v1::TraverseService::Stub::ListTraverses, list), IsOk());
}

}  // namespace
}  // namespace curvereg::server
