// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A ScanService on a port of the loopback interface with a real store in a temporary folder, and clients for it.
#ifndef CURVEREG_TESTS_SERVER_SCANS_SCAN_SERVER_H_
#define CURVEREG_TESTS_SERVER_SCANS_SCAN_SERVER_H_

#include <grpcpp/client_context.h>
#include <grpcpp/server.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "curvereg/v1/scan_service.grpc.pb.h"
#include "server/preparation/prepared_scan_cache.h"
#include "server/scans/scan_service.h"
#include "wire/error.h"

namespace curvereg::testing {

struct ScanServerOptions {
  server::LimitsConfig limits;
  server::ScanStoreOptions store;
  uint64_t memory_bytes = uint64_t{1} << 30;
  server::WorkerPoolOptions disk_pool = {.num_workers = 2, .max_queue_length = 1024, .max_queue_per_client = 1024};
  const server::Access* access = nullptr;  // null: open
};

// Reports what goes wrong on starting as a failure of the test.
class ScanServer {
 public:
  explicit ScanServer(const ScanServerOptions& options = {});
  ~ScanServer();

  // A connection of its own each time.
  std::shared_ptr<grpc::Channel> NewChannel() const;
  std::unique_ptr<v1::ScanService::Stub> NewStub() const { return v1::ScanService::NewStub(NewChannel()); }
  // Ends everything at once and opens the same folder again.
  void Restart();
  void Drain() { draining_.request_stop(); }
  void EndCalls() { ending_.request_stop(); }

  grpc::Server& server() { return *server_; }
  server::ScanStore& store() { return *store_; }
  server::MemoryBudget& memory() { return *memory_; }
  server::PreparedScanCache& cache() { return *cache_; }
  server::WorkerPool& disk_pool() { return *disk_pool_; }
  const server::Metrics& metrics() const { return metrics_; }
  server::Metrics& metrics() { return metrics_; }
  const std::filesystem::path& folder() const { return folder_; }

 private:
  void StartUp();
  void TearDown();

  const ScanServerOptions options_;
  std::filesystem::path folder_;
  std::unique_ptr<server::Access> open_access_ = server::Access::Open();
  server::Metrics metrics_;
  std::stop_source draining_;
  std::stop_source ending_;
  std::unique_ptr<server::MemoryBudget> memory_;
  std::unique_ptr<server::PreparedScanCache> cache_;
  std::unique_ptr<server::WorkerPool> disk_pool_;
  std::unique_ptr<server::ScanStore> store_;
  std::unique_ptr<server::ScanService> service_;
  std::unique_ptr<grpc::Server> server_;
  int port_ = 0;
};

// A cloud of `num_points` random points as RAW bytes.
v1::PointCloud RandomCloud(int num_points, uint64_t seed);

v1::Digest Xxh3(const std::string& bytes);
v1::Digest Sha256(const std::string& bytes);

v1::UploadScanRequest StartMessage(const std::string& upload, const v1::PointCloud& cloud, bool with_digest = true);
// The bytes [offset, offset + size) of the cloud, fewer at its end, with their CRC.
v1::UploadScanRequest ChunkMessage(const v1::PointCloud& cloud, uint64_t offset, uint64_t size);
v1::UploadScanRequest FinishMessage(const std::optional<v1::Digest>& digest = std::nullopt);

// Far more than any call of a test takes on a slow machine whose disk is busy: what hangs then says so, by
// DEADLINE_EXCEEDED, before the test as a whole is ended without a word.
constexpr std::chrono::minutes kCallTimeout{5};

// For a call that waits while a connection is slow to come, and no longer than `timeout`.
void SetDeadline(grpc::ClientContext& context, std::chrono::milliseconds timeout = kCallTimeout);

// One upload stream, as a client has it.
class UploadClient {
 public:
  explicit UploadClient(v1::ScanService::Stub& stub, std::chrono::milliseconds timeout = kCallTimeout);
  ~UploadClient();  // cancels

  bool Send(const v1::UploadScanRequest& request) { return stream_->Write(request); }
  void HalfClose() { stream_->WritesDone(); }
  void Cancel() { context_.TryCancel(); }
  // The next answer; none when the stream has ended.
  std::optional<v1::UploadScanResponse> Receive();
  // Reads on until the committed offset told is at least `offset`; false when the stream ends before.
  bool ReceiveProgress(uint64_t offset);
  // Reads to the end: the status, and the last answer.
  absl::Status End();
  const v1::UploadScanResponse& last() const { return last_; }
  grpc::ClientContext& context() { return context_; }

 private:
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<v1::UploadScanRequest, v1::UploadScanResponse>> stream_;
  v1::UploadScanResponse last_;
  bool ended_ = false;
};

// Start, wait for ready, chunks from there on, finish, to the end. Returns the last answer.
absl::StatusOr<v1::UploadScanDone> Upload(v1::ScanService::Stub& stub, const std::string& upload,
                                          const v1::PointCloud& cloud, uint64_t chunk_bytes = 64 << 10);

// Sends all that without waiting for anything, and half-closes. Returns the end.
absl::Status SendAll(v1::ScanService::Stub& stub, const std::vector<v1::UploadScanRequest>& requests);

// As the store has it; a failure of the test when there is no such upload.
uint64_t CommittedBytes(ScanServer& server, const std::string& upload);

// What a download brought.
struct Downloaded {
  std::optional<v1::Scan> scan;
  std::vector<v1::PayloadChunk> chunks;
  absl::Status status;
  std::string Bytes() const;
};
Downloaded Download(v1::ScanService::Stub& stub, const v1::DownloadScanRequest& request);

// Asks every few milliseconds; false after 20 s.
bool WaitUntil(const std::function<bool()>& condition);

// Calls of a method that the server has not ended yet.
int OpenCalls(const ScanServer& server, const std::string& method);

// Sum of the samples of a metric whose labels contain `label`.
double MetricValue(const ScanServer& server, const std::string& name, const std::string& label = "");

// "CHECKSUM_MISMATCH"; "OK"; "none" for an error without a reason.
std::string ReasonText(const absl::Status& status);
// Value of the ErrorInfo's metadata; empty: not there.
std::string MetadataOf(const absl::Status& status, const std::string& key);

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_SERVER_SCANS_SCAN_SERVER_H_
