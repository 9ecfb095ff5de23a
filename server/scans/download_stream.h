// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The streaming of one DownloadScan call: while one chunk is being written, the disk pool reads the next, and no more
// than that.
#ifndef CURVEREG_SERVER_SCANS_DOWNLOAD_STREAM_H_
#define CURVEREG_SERVER_SCANS_DOWNLOAD_STREAM_H_

#include <grpcpp/support/server_callback.h>

#include <mutex>
#include <optional>

#include "absl/status/status.h"
#include "curvereg/v1/scan_service.pb.h"
#include "server/call.h"
#include "server/scheduling/worker_pool.h"
#include "server/settings/server_config.h"
#include "server/store/scan_store.h"
#include "wire/digest.h"

namespace curvereg::server {

// Reactions of gRPC and the end of a task are events: each changes the state under the mutex and calls Advance, the one
// place that starts anything. Life as in upload_stream.h: Finish is called once, when no task is out and nothing is
// being written, and whoever calls it touches the object no more.
class DownloadStream final : public grpc::ServerWriteReactor<v1::DownloadScanResponse> {
 public:
  // Everything in it outlives the call.
  struct Environment {
    CallEnvironment calls;
    LimitsConfig limits;
    ScanStore* store = nullptr;
    WorkerPool* disk_pool = nullptr;
  };
  // `request` is gRPC's, which keeps it until OnDone.
  DownloadStream(const Environment& environment, grpc::CallbackServerContext& context,
                 const v1::DownloadScanRequest& request);

  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override { delete this; }

 private:
  ~DownloadStream() override = default;

  // The task: makes the next message, the scan or a chunk.
  absl::Status Work();
  absl::Status OpenScan();
  absl::Status ReadChunk();
  void OnWorked(const absl::Status& status);

  // These with the mutex held. Advance gives the lock back.
  void End(const absl::Status& status);  // the first reason counts
  void Advance(std::unique_lock<std::mutex> lock);

  const Environment& environment_;
  const v1::DownloadScanRequest& request_;
  Call call_;

  std::mutex mutex_;
  bool working_ = false;   // a task is out; what the task keeps is its own
  bool ready_ = false;     // next_ is to be written
  bool writing_ = false;   // written_
  bool finished_ = false;  // Finish was called, or is about to be
  std::optional<absl::Status> end_;
  v1::DownloadScanResponse written_;
  v1::DownloadScanResponse next_;  // the task's while working_

  // What the task keeps.
  std::optional<StoredScan> scan_;
  uint64_t offset_ = 0;                     // of the next chunk
  std::optional<wire::Digester> digester_;  // of a whole download
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_SCANS_DOWNLOAD_STREAM_H_
