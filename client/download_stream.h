// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// One stream of a download: from an offset to the end or to the next cut.
#ifndef CURVEREG_CLIENT_DOWNLOAD_STREAM_H_
#define CURVEREG_CLIENT_DOWNLOAD_STREAM_H_

#include <grpcpp/client_context.h>
#include <grpcpp/support/client_callback.h>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>

#include "absl/status/status.h"
#include "client/connection.h"
#include "curvereg/v1/scan_service.pb.h"

namespace curvereg::internal {

// What has come; kept from stream to stream.
struct DownloadState {
  std::optional<v1::Scan> scan;  // the first stream's; later ones must agree
  std::string payload;           // checked bytes from the start
};

class DownloadStream final : public grpc::ClientReadReactor<v1::DownloadScanResponse> {
 public:
  // `state` is the stream's until Run returns.
  DownloadStream(const v1::DownloadScanRequest& request, DownloadState& state)
      : request_(request), state_(state), last_answer_(std::chrono::steady_clock::now()) {}

  // Blocks until the stream has ended; a server that is silent for `silence` is given up. `on_progress` is called from
  // here with the number of bytes that are there.
  absl::Status Run(Connection& connection, const std::shared_ptr<grpc::Channel>& channel,
                   std::chrono::milliseconds silence, const std::stop_token& cancellation,
                   const std::function<void(uint64_t)>& on_progress);

  void OnReadDone(bool ok) override;
  void OnDone(const grpc::Status& status) override;

 private:
  absl::Status Take(const v1::DownloadScanResponse& response);
  absl::Status TakeScan(const v1::Scan& scan);
  absl::Status TakeChunk(const v1::PayloadChunk& chunk);
  bool Await(std::chrono::milliseconds silence, const std::function<void(uint64_t)>& on_progress);

  const v1::DownloadScanRequest& request_;
  grpc::ClientContext context_;
  v1::DownloadScanResponse response_;

  std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  DownloadState& state_;
  bool has_scan_ = false;
  absl::Status broken_;  // what was wrong with an answer
  std::chrono::steady_clock::time_point last_answer_;
  std::optional<grpc::Status> ended_;
};

}  // namespace curvereg::internal

#endif  // CURVEREG_CLIENT_DOWNLOAD_STREAM_H_
