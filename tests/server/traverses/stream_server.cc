// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/server/traverses/stream_server.h"

#include <grpcpp/create_channel.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "tests/server/traverses/fake_traverses.h"
#include "wire/digest.h"
#include "wire/status_mapping.h"

namespace curvereg::testing {

StreamServer::StreamServer(server::Traverses& traverses, const StreamServerOptions& options)
    : scans_(options.scans), pool_({.num_workers = 1}) {
  server::TraverseBackend backend;
  backend.calls.access = options.scans.access != nullptr ? options.scans.access : access_.get();
  backend.calls.metrics = &scans_.metrics();
  backend.calls.draining = draining_.get_token();
  backend.scans = {.limits = options.scans.limits,
                   .memory = &scans_.memory(),
                   .cache = &scans_.cache(),
                   .store = &scans_.store(),
                   .metrics = &scans_.metrics()};
  backend.pool = &pool_;
  backend.disk_pool = &scans_.disk_pool();
  backend.traverses = &traverses;
  backend.maps = options.maps;
  service_ = std::make_unique<server::TraverseService>(backend);
  grpc::ServerBuilder builder;
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port_);
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  builder.RegisterService(service_.get());
  server_ = builder.BuildAndStart();
  EXPECT_NE(server_, nullptr);
}

StreamServer::~StreamServer() {
  server_->Shutdown(std::chrono::system_clock::now());
  server_.reset();
}

std::unique_ptr<v1::TraverseService::Stub> StreamServer::NewStub() const {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  return v1::TraverseService::NewStub(
      grpc::CreateCustomChannel(absl::StrCat("127.0.0.1:", port_), grpc::InsecureChannelCredentials(), arguments));
}

v1::StreamScansRequest StreamStart(std::optional<uint64_t> last_result) {
  v1::StreamScansRequest request;
  request.mutable_start()->set_traverse(FakeTraverses::kName);
  if (last_result.has_value()) request.mutable_start()->set_last_result_sequence_number(*last_result);
  return request;
}

v1::StreamScansRequest StreamHeader(uint64_t sequence_number, const v1::PointCloud& cloud) {
  v1::StreamScansRequest request;
  v1::StreamedScanHeader& header = *request.mutable_header();
  header.set_sequence_number(sequence_number);
  *header.mutable_header() = cloud.header();
  header.set_payload_bytes(cloud.data().size());
  *header.mutable_payload_digest() = Xxh3(cloud.data());
  return request;
}

v1::StreamScansRequest StreamChunk(const v1::PointCloud& cloud, uint64_t offset, uint64_t size) {
  v1::StreamScansRequest request;
  *request.mutable_chunk() = ChunkMessage(cloud, offset, size).chunk();
  return request;
}

StreamClient::StreamClient(v1::TraverseService::Stub& stub, std::chrono::milliseconds timeout) {
  SetDeadline(context_, timeout);
  stream_ = stub.StreamScans(&context_);
}

StreamClient::~StreamClient() {
  if (ended_) return;
  context_.TryCancel();
  End().IgnoreError();
}

bool StreamClient::SendScan(uint64_t sequence_number, const v1::PointCloud& cloud, uint64_t chunk_bytes) {
  bool sent = Send(StreamHeader(sequence_number, cloud));
  for (uint64_t offset = 0; sent && offset < cloud.data().size(); offset += chunk_bytes) {
    sent = Send(StreamChunk(cloud, offset, chunk_bytes));
  }
  return sent;
}

std::optional<v1::StreamScansResponse> StreamClient::Receive() {
  v1::StreamScansResponse response;
  if (!stream_->Read(&response)) return std::nullopt;
  if (response.has_ack()) acks_[response.ack().sequence_number()] = response.ack();
  if (response.has_result()) results_.push_back(response.result());
  return response;
}

v1::StreamScansReady StreamClient::Begin(std::optional<uint64_t> last_result) {
  Send(StreamStart(last_result));
  const std::optional<v1::StreamScansResponse> answer = Receive();
  EXPECT_TRUE(answer.has_value() && answer->has_ready()) << End();
  return answer.has_value() ? answer->ready() : v1::StreamScansReady();
}

template <typename Condition>
bool StreamClient::ReceiveUntil(const Condition& condition) {
  while (const std::optional<v1::StreamScansResponse> answer = Receive()) {
    if (condition(*answer)) return true;
  }
  return false;
}

bool StreamClient::ReceiveComplete(uint64_t sequence_number) {
  return ReceiveUntil([&](const v1::StreamScansResponse& answer) {
    return answer.has_ack() && answer.ack().sequence_number() == sequence_number && answer.ack().complete();
  });
}

bool StreamClient::ReceiveResult(uint64_t sequence_number) {
  return ReceiveUntil([&](const v1::StreamScansResponse& answer) {
    return answer.has_result() && answer.result().sequence_number() == sequence_number;
  });
}

bool StreamClient::ReceiveOffset(uint64_t sequence_number, uint64_t offset) {
  return ReceiveUntil([&](const v1::StreamScansResponse& answer) {
    return answer.has_ack() && answer.ack().sequence_number() == sequence_number &&
           answer.ack().committed_offset() >= offset;
  });
}

absl::Status StreamClient::End() {
  while (Receive().has_value()) {
  }
  ended_ = true;
  return wire::FromGrpcStatus(stream_->Finish());
}

std::vector<uint64_t> StreamClient::ResultNumbers() const {
  std::vector<uint64_t> numbers;
  for (const v1::ScanResult& result : results_) numbers.push_back(result.sequence_number());
  return numbers;
}

}  // namespace curvereg::testing
