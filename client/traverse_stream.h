// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// One stream of scans: from `start` to the end of the work or to the next cut.
#ifndef CURVEREG_CLIENT_TRAVERSE_STREAM_H_
#define CURVEREG_CLIENT_TRAVERSE_STREAM_H_

#include <grpcpp/client_context.h>
#include <grpcpp/support/client_callback.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "absl/status/status.h"
#include "client/connection.h"
#include "client/traverse_send_queue.h"
#include "curvereg/v1/traverse_service.pb.h"

namespace curvereg::internal {

class TraverseStream final : public grpc::ClientBidiReactor<v1::StreamScansRequest, v1::StreamScansResponse> {
 public:
  // `traverse`: its name. The queue outlives the stream.
  TraverseStream(const std::string& traverse, TraverseSendQueue& queue);

  struct Limits {
    std::chrono::milliseconds silence{0};  // without an answer while one is due: the link is dead
    std::stop_token cancellation;
  };
  // Blocks until the stream has ended; OK: all is sent, acknowledged and answered. Calls `tell` from here, without any
  // lock, when there may be something to tell the caller, and `on_alive` each time the stream proves to work.
  absl::Status Run(Connection& connection, const std::shared_ptr<grpc::Channel>& channel, const Limits& limits,
                   const std::function<void()>& tell, const std::function<void()>& on_alive);

  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnDone(const grpc::Status& status) override;

 private:
  using Clock = std::chrono::steady_clock;
  // What follows is called with the queue's mutex held, but for SendNext and Finished.
  void Await(const Limits& limits, const std::function<void()>& tell, const std::function<void()>& on_alive);
  void WatchSilence(std::chrono::milliseconds patience);
  bool AnswerIsDue() const;
  absl::Status Take(const v1::StreamScansResponse& response);
  absl::Status TakeReady(const v1::StreamScansReady& ready);
  absl::Status TakeAck(const v1::StreamScansAck& ack);
  // Makes message_ the next one to send; false: nothing to send now.
  bool MakeNext();
  bool MakeHeader(WaitingScan& scan);
  bool MakeChunk(WaitingScan& scan);
  void EndCursorScan();
  void Break(const absl::Status& why);
  // Sends what may be sent now, unless a message is on its way to gRPC.
  void SendNext();
  void EndWork();
  absl::Status Outcome(const Limits& limits) const;

  TraverseSendQueue& queue_;
  grpc::ClientContext context_;
  v1::StreamScansRequest message_;  // the one being written
  v1::StreamScansResponse response_;

  // Guarded by the queue's mutex.
  uint64_t next_ = 0;         // sequence number of the scan being sent
  uint64_t offset_ = 0;       // of its next chunk
  bool header_sent_ = false;  // of that scan
  uint64_t bytes_sent_ = 0;   // in this stream
  uint64_t max_chunk_bytes_ = 0;
  std::optional<Clock::time_point> ready_at_;
  bool writing_ = true;  // `start`
  bool finishing_ = false;
  bool silent_ = false;
  bool closed_ = false;          // no more answers come
  absl::Status broken_;          // what was wrong with an answer, or cannot be sent
  Clock::time_point due_since_;  // last answer, or when one became due
  bool was_due_ = true;
  std::optional<Clock::time_point> finished_at_;
  std::optional<grpc::Status> ended_;
};

}  // namespace curvereg::internal

#endif  // CURVEREG_CLIENT_TRAVERSE_STREAM_H_
