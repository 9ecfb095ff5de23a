// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A TraverseService on a port of the loopback interface, over a real store, and clients for them.
#ifndef CURVEREG_TESTS_SERVER_TRAVERSES_STREAM_SERVER_H_
#define CURVEREG_TESTS_SERVER_TRAVERSES_STREAM_SERVER_H_

#include <grpcpp/server.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "curvereg/v1/traverse_service.grpc.pb.h"
#include "server/traverses/traverse_service.h"
#include "tests/server/scans/scan_server.h"

namespace curvereg::testing {

struct StreamServerOptions {
  ScanServerOptions scans;
  server::MapBuilder* maps = nullptr;  // null: no DownloadMap
};

// Reports what goes wrong on starting as a failure of the test.
class StreamServer {
 public:
  explicit StreamServer(server::Traverses& traverses, const StreamServerOptions& options = {});
  ~StreamServer();

  std::unique_ptr<v1::TraverseService::Stub> NewStub() const;  // on a connection of its own
  void Drain() { draining_.request_stop(); }
  ScanServer& scans() { return scans_; }
  server::WorkerPool& pool() { return pool_; }
  int OpenCalls(const std::string& method) const { return testing::OpenCalls(scans_, method); }

 private:
  ScanServer scans_;  // its store, memory, metrics and pool are ours as well
  std::unique_ptr<server::Access> access_ = server::Access::Open();
  std::stop_source draining_;
  server::WorkerPool pool_;
  std::unique_ptr<server::TraverseService> service_;
  std::unique_ptr<grpc::Server> server_;
  int port_ = 0;
};

v1::StreamScansRequest StreamStart(std::optional<uint64_t> last_result = std::nullopt);
v1::StreamScansRequest StreamHeader(uint64_t sequence_number, const v1::PointCloud& cloud);
// The bytes [offset, offset + size) of the cloud, fewer at its end, with their CRC.
v1::StreamScansRequest StreamChunk(const v1::PointCloud& cloud, uint64_t offset, uint64_t size);

// One stream, as a client has it. What is received is kept.
class StreamClient {
 public:
  explicit StreamClient(v1::TraverseService::Stub& stub, std::chrono::milliseconds timeout = kCallTimeout);
  ~StreamClient();  // cancels

  bool Send(const v1::StreamScansRequest& request) { return stream_->Write(request); }
  // Header and chunks, without waiting for anything.
  bool SendScan(uint64_t sequence_number, const v1::PointCloud& cloud, uint64_t chunk_bytes = 4000);
  void HalfClose() { stream_->WritesDone(); }
  void Cancel() { context_.TryCancel(); }
  // The next answer; none when the stream has ended.
  std::optional<v1::StreamScansResponse> Receive();
  // Sends start and receives ready; a failure of the test when something else comes.
  v1::StreamScansReady Begin(std::optional<uint64_t> last_result = std::nullopt);
  // Read on until then; false when the stream ends before.
  bool ReceiveComplete(uint64_t sequence_number);
  bool ReceiveResult(uint64_t sequence_number);
  bool ReceiveOffset(uint64_t sequence_number, uint64_t offset);
  // Reads to the end.
  absl::Status End();

  const std::vector<v1::ScanResult>& results() const { return results_; }
  const std::map<uint64_t, v1::StreamScansAck>& acks() const { return acks_; }  // the last of each scan
  std::vector<uint64_t> ResultNumbers() const;

 private:
  template <typename Condition>
  bool ReceiveUntil(const Condition& condition);

  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<v1::StreamScansRequest, v1::StreamScansResponse>> stream_;
  std::vector<v1::ScanResult> results_;
  std::map<uint64_t, v1::StreamScansAck> acks_;
  bool ended_ = false;
};

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_SERVER_TRAVERSES_STREAM_SERVER_H_
