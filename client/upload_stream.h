// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// One stream of an upload: from `start` to `done` or to the next cut.
#ifndef CURVEREG_CLIENT_UPLOAD_STREAM_H_
#define CURVEREG_CLIENT_UPLOAD_STREAM_H_

#include <grpcpp/client_context.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/client_callback.h>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "client/connection.h"
#include "client/upload_messages.h"
#include "client/upload_window.h"
#include "curvereg/v1/scan_service.pb.h"

namespace curvereg::internal {

// What is uploaded; the same for all streams of an upload.
struct UploadSource {
  v1::UploadScanStart start;
  UploadPayload payload;
};

// How far it got; kept from stream to stream.
struct UploadState {
  uint64_t committed = 0;         // acknowledged
  uint64_t sent_end = 0;          // greatest offset ever sent
  uint64_t bytes_resent = 0;      // sent more than once
  bool has_others_bytes = false;  // the server had bytes that were never sent here
  std::optional<v1::UploadScanDone> done;
};

class UploadStream final : public grpc::ClientBidiReactor<grpc::ByteBuffer, v1::UploadScanResponse> {
 public:
  UploadStream(const UploadSource& source, const UploadState& state, const UploadWindow::Options& window);

  struct Limits {
    std::chrono::milliseconds silence{0};         // without an answer while one is due: the link is dead
    std::chrono::milliseconds finish_silence{0};  // the same after `finish`, when the server checks and stores
    std::stop_token cancellation;
  };
  // Blocks until the stream has ended. `on_progress` is called from here, each time the committed offset moved.
  absl::Status Run(Connection& connection, const std::shared_ptr<grpc::Channel>& channel, const Limits& limits,
                   const std::function<void(const UploadState&)>& on_progress);
  const UploadState& state() const { return state_; }  // after Run

  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnDone(const grpc::Status& status) override;

 private:
  // With mutex_ held: what the server said; false: it makes no sense.
  bool Take(const v1::UploadScanResponse& response);
  bool TakeReady(const v1::UploadScanReady& ready);
  bool TakeCommitted(uint64_t committed);
  // Sends what may be sent now, unless a message is on its way to gRPC.
  void SendNext();
  // Until the stream has ended; true: it was ended because the server fell silent.
  bool Await(const Limits& limits, const std::function<void(const UploadState&)>& on_progress);

  const UploadSource& source_;
  const uint64_t begun_at_;  // committed offset that the caller knows
  grpc::ClientContext context_;
  v1::UploadScanResponse response_;
  grpc::ByteBuffer message_;  // the one being written

  std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  UploadState state_;
  UploadWindow window_;
  uint64_t offset_ = 0;  // of the next chunk
  uint64_t max_chunk_bytes_ = 0;
  bool ready_ = false;
  bool writing_ = true;  // `start`
  bool finish_sent_ = false;
  bool nonsense_ = false;
  std::chrono::steady_clock::time_point last_answer_;
  std::optional<grpc::Status> ended_;
};

}  // namespace curvereg::internal

#endif  // CURVEREG_CLIENT_UPLOAD_STREAM_H_
