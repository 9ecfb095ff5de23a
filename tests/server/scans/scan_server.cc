// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/server/scans/scan_server.h"

#include <grpcpp/create_channel.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <sstream>
#include <thread>

#include "absl/strings/str_cat.h"
#include "server/preparation/scan_deletion.h"
#include "tests/testing/scenes.h"
#include "wire/digest.h"
#include "wire/point_codec.h"
#include "wire/status_mapping.h"

namespace curvereg::testing {
namespace {

using Clock = std::chrono::steady_clock;

std::filesystem::path NewFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "curvereg-scans-XXXXXX").string();
  EXPECT_NE(mkdtemp(name.data()), nullptr);
  return name;
}

}  // namespace

ScanServer::ScanServer(const ScanServerOptions& options) : options_(options), folder_(NewFolder()) { StartUp(); }

ScanServer::~ScanServer() {
  TearDown();
  std::filesystem::remove_all(folder_);
}

void ScanServer::Restart() {
  TearDown();
  StartUp();
}

void ScanServer::StartUp() {
  absl::StatusOr<std::unique_ptr<server::ScanStore>> store = server::ScanStore::Open(folder_.string(), options_.store);
  ASSERT_TRUE(store.ok()) << store.status();
  store_ = *std::move(store);
  memory_ = std::make_unique<server::MemoryBudget>(options_.memory_bytes);
  cache_ = std::make_unique<server::PreparedScanCache>(uint64_t{64} << 20);
  disk_pool_ = std::make_unique<server::WorkerPool>(options_.disk_pool);
  server::ScanBackend backend;
  backend.calls.access = options_.access != nullptr ? options_.access : open_access_.get();
  backend.calls.metrics = &metrics_;
  backend.calls.draining = draining_.get_token();
  backend.calls.ending = ending_.get_token();
  backend.limits = options_.limits;
  backend.disk_pool = disk_pool_.get();
  backend.memory = memory_.get();
  backend.store = store_.get();
  backend.delete_scan = [this](const std::string& scan_id) {
    return server::DeleteStoredScan(scan_id, *store_, *cache_);
  };
  service_ = std::make_unique<server::ScanService>(backend);
  grpc::ServerBuilder builder;
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port_);
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  builder.SetMaxReceiveMessageSize(static_cast<int>(options_.limits.max_message_bytes));
  builder.RegisterService(service_.get());
  server_ = builder.BuildAndStart();
  ASSERT_NE(server_, nullptr);
}

void ScanServer::TearDown() {
  if (server_ != nullptr) server_->Shutdown(std::chrono::system_clock::now());
  server_.reset();
  service_.reset();
  if (disk_pool_ != nullptr) disk_pool_->Shutdown(Clock::now() + std::chrono::seconds(10));
  disk_pool_.reset();
  store_.reset();
}

std::shared_ptr<grpc::Channel> ScanServer::NewChannel() const {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  arguments.SetMaxReceiveMessageSize(64 << 20);
  return grpc::CreateCustomChannel(absl::StrCat("127.0.0.1:", port_), grpc::InsecureChannelCredentials(), arguments);
}

v1::PointCloud RandomCloud(int num_points, uint64_t seed) {
  Random random(seed);
  Scan scan;
  for (int i = 0; i < num_points; ++i) {
    scan.points.emplace_back(static_cast<float>(random.Uniform(-20, 20)), static_cast<float>(random.Uniform(-20, 20)),
                             static_cast<float>(random.Uniform(-2, 2)));
  }
  const absl::StatusOr<v1::PointCloud> cloud = wire::EncodeScan(scan);
  EXPECT_TRUE(cloud.ok()) << cloud.status();
  return cloud.ok() ? *cloud : v1::PointCloud();
}

v1::Digest Xxh3(const std::string& bytes) { return wire::DigestOf(v1::DIGEST_ALGORITHM_XXH3_128, bytes); }

v1::Digest Sha256(const std::string& bytes) { return wire::DigestOf(v1::DIGEST_ALGORITHM_SHA256, bytes); }

v1::UploadScanRequest StartMessage(const std::string& upload, const v1::PointCloud& cloud, bool with_digest) {
  v1::UploadScanRequest request;
  v1::UploadScanStart& start = *request.mutable_start();
  start.set_upload(absl::StrCat("uploads/", upload));
  *start.mutable_header() = cloud.header();
  start.set_payload_bytes(cloud.data().size());
  if (with_digest) *start.mutable_payload_digest() = Xxh3(cloud.data());
  return request;
}

v1::UploadScanRequest ChunkMessage(const v1::PointCloud& cloud, uint64_t offset, uint64_t size) {
  v1::UploadScanRequest request;
  v1::PayloadChunk& chunk = *request.mutable_chunk();
  chunk.set_offset(offset);
  chunk.set_data(cloud.data().substr(offset, size));
  chunk.set_crc32c(wire::Crc32c(chunk.data()));
  return request;
}

v1::UploadScanRequest FinishMessage(const std::optional<v1::Digest>& digest) {
  v1::UploadScanRequest request;
  request.mutable_finish();
  if (digest.has_value()) *request.mutable_finish()->mutable_payload_digest() = *digest;
  return request;
}

void SetDeadline(grpc::ClientContext& context, std::chrono::milliseconds timeout) {
  context.set_wait_for_ready(true);
  context.set_deadline(std::chrono::system_clock::now() + timeout);
}

UploadClient::UploadClient(v1::ScanService::Stub& stub, std::chrono::milliseconds timeout) {
  SetDeadline(context_, timeout);
  stream_ = stub.UploadScan(&context_);
}

UploadClient::~UploadClient() {
  if (ended_) return;
  context_.TryCancel();
  End().IgnoreError();
}

std::optional<v1::UploadScanResponse> UploadClient::Receive() {
  v1::UploadScanResponse response;
  if (!stream_->Read(&response)) return std::nullopt;
  last_ = response;
  return response;
}

bool UploadClient::ReceiveProgress(uint64_t offset) {
  while (const std::optional<v1::UploadScanResponse> answer = Receive()) {
    if (answer->has_progress() && answer->progress().committed_offset() >= offset) return true;
  }
  return false;
}

absl::Status UploadClient::End() {
  while (Receive().has_value()) {
  }
  ended_ = true;
  return wire::FromGrpcStatus(stream_->Finish());
}

absl::StatusOr<v1::UploadScanDone> Upload(v1::ScanService::Stub& stub, const std::string& upload,
                                          const v1::PointCloud& cloud, uint64_t chunk_bytes) {
  UploadClient client(stub);
  client.Send(StartMessage(upload, cloud));
  const std::optional<v1::UploadScanResponse> first = client.Receive();
  if (first.has_value() && first->has_ready()) {
    for (uint64_t offset = first->ready().committed_offset(); offset < cloud.data().size(); offset += chunk_bytes) {
      if (!client.Send(ChunkMessage(cloud, offset, chunk_bytes))) break;
    }
    client.Send(FinishMessage());
  }
  const absl::Status status = client.End();
  if (!status.ok()) return status;
  if (!client.last().has_done()) return absl::InternalError("OK without done");
  return client.last().done();
}

absl::Status SendAll(v1::ScanService::Stub& stub, const std::vector<v1::UploadScanRequest>& requests) {
  UploadClient client(stub);
  for (const v1::UploadScanRequest& request : requests) {
    if (!client.Send(request)) break;
  }
  client.HalfClose();
  return client.End();
}

uint64_t CommittedBytes(ScanServer& server, const std::string& upload) {
  const absl::StatusOr<server::UploadState> state = server.store().GetUpload(upload);
  EXPECT_TRUE(state.ok()) << state.status();
  return state.ok() ? state->committed_offset : 0;
}

std::string Downloaded::Bytes() const {
  std::string bytes;
  for (const v1::PayloadChunk& chunk : chunks) bytes += chunk.data();
  return bytes;
}

Downloaded Download(v1::ScanService::Stub& stub, const v1::DownloadScanRequest& request) {
  grpc::ClientContext context;
  SetDeadline(context);
  const auto stream = stub.DownloadScan(&context, request);
  Downloaded downloaded;
  v1::DownloadScanResponse response;
  while (stream->Read(&response)) {
    if (response.has_scan()) {
      EXPECT_FALSE(downloaded.scan.has_value()) << "the scan came a second time";
      EXPECT_TRUE(downloaded.chunks.empty()) << "the scan must come first";
      downloaded.scan = response.scan();
    } else {
      downloaded.chunks.push_back(response.chunk());
    }
  }
  downloaded.status = wire::FromGrpcStatus(stream->Finish());
  return downloaded;
}

bool WaitUntil(const std::function<bool()>& condition) {
  const auto deadline = Clock::now() + std::chrono::seconds(20);
  while (!condition()) {
    if (Clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

int OpenCalls(const ScanServer& server, const std::string& method) {
  return static_cast<int>(MetricValue(server, "grpc_server_started_total", method) -
                          MetricValue(server, "grpc_server_handled_total", method));
}

double MetricValue(const ScanServer& server, const std::string& name, const std::string& label) {
  std::istringstream lines(server.metrics().Text());
  double sum = 0.0;
  for (std::string line; std::getline(lines, line);) {
    const size_t end = line.find_first_of("{ ");
    if (line.substr(0, end) != name || line.find(label) == std::string::npos) continue;
    sum += std::stod(line.substr(line.rfind(' ')));
  }
  return sum;
}

std::string ReasonText(const absl::Status& status) {
  if (status.ok()) return "OK";
  const std::optional<google::rpc::ErrorInfo> info = wire::ErrorInfoOf(status);
  return info.has_value() ? info->reason() : "none";
}

std::string MetadataOf(const absl::Status& status, const std::string& key) {
  const std::optional<google::rpc::ErrorInfo> info = wire::ErrorInfoOf(status);
  if (!info.has_value() || !info->metadata().contains(key)) return "";
  return info->metadata().at(key);
}

}  // namespace curvereg::testing
