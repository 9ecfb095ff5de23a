// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// One DownloadScan call: while one chunk is being written, the disk pool reads the next, and no more than that. The
// stream ends with OK only when the whole payload, also the part before the requested offset, has its digest.
#ifndef CURVEREG_SERVER_SCANS_DOWNLOAD_STREAM_H_
#define CURVEREG_SERVER_SCANS_DOWNLOAD_STREAM_H_

#include <cstdint>
#include <deque>
#include <optional>

#include "curvereg/v1/scan_service.pb.h"
#include "server/rpc/call.h"
#include "server/rpc/response_stream.h"
#include "server/scheduling/worker_pool.h"
#include "server/settings/server_config.h"
#include "server/store/scan_store.h"
#include "wire/digest.h"

namespace curvereg::server {

class DownloadStream final : public ResponseStream<v1::DownloadScanResponse> {
 public:
  static const MethodTraits kTraits;

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

 private:
  ~DownloadStream() override = default;

  // Adds one message: the scan, then chunks. None while it reads the part before the requested offset.
  absl::StatusOr<Next> Make(std::deque<v1::DownloadScanResponse>& made) override;
  WorkerPool& pool() override { return *environment_.disk_pool; }

  absl::Status OpenScan(v1::DownloadScanResponse& response);
  absl::Status SkipPiece();
  absl::Status ReadChunk(v1::DownloadScanResponse& response);
  absl::Status CheckDigest();

  const Environment& environment_;
  const v1::DownloadScanRequest& request_;
  std::optional<StoredScan> scan_;
  uint64_t offset_ = 0;                     // of the next bytes to read
  std::optional<wire::Digester> digester_;  // of those before; from OpenScan on
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_SCANS_DOWNLOAD_STREAM_H_
