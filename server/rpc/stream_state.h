// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// When a streaming call reads, works, writes and ends, without its messages and without gRPC. ChunkStream and
// ResponseStream report each event to it and ask it what to start next.
#ifndef CURVEREG_SERVER_RPC_STREAM_STATE_H_
#define CURVEREG_SERVER_RPC_STREAM_STATE_H_

#include <cstddef>
#include <functional>
#include <optional>

#include "absl/status/status.h"

namespace curvereg::server {

// At most one read, one write and one task are under way at a time. The call is finished once, when no task and no
// write is under way. Not thread-safe: the stream's mutex is held.
class StreamState {
 public:
  // Requests read ahead: enough that neither the disk nor the link waits for the other at every chunk.
  static constexpr std::size_t kMaxPendingRequests = 3;
  // Answers that the client has not taken; beyond it nothing more is done for it.
  static constexpr std::size_t kMaxPendingAnswers = 16;

  // Lengths of the stream's queues.
  struct Pending {
    std::size_t num_requests = 0;       // no task has taken them yet
    std::size_t num_answers = 0;        // to requests; written before notifications
    std::size_t num_notifications = 0;  // what the server sends by itself
  };
  enum class Output { kNothing, kAnswer, kNotification, kFinish, kFinishWithLastAnswer };
  struct Task {
    bool handles_requests = false;
    bool takes_notifications = false;
    bool is_due() const { return handles_requests || takes_notifications; }
  };

  // What has happened.
  void ReadEnded() { is_reading_ = false; }  // with a request or without
  // Nothing more is read. OK: the client ended its side; its requests count. An error ends the call after them.
  void EndInput(const absl::Status& status);
  void WriteEnded() { is_writing_ = false; }
  void TaskEnded(const absl::Status& status);
  void Notify() { notifications_due_ = true; }  // there may be notifications that no task has taken
  void Drain() { is_draining_ = true; }         // the call ends with NOT_SERVING once it is idle
  void End(const absl::Status& status);         // nothing new is begun; answers are still written. The first one counts
  void Interrupt(const absl::Status& status);   // End, and nothing more is written

  // What to do next: these four in this order after each of the above.
  //
  // Ends the call when no task is under way, no request is pending, and the server drains or the input has ended.
  // `end_of_input` is asked where it ended with OK: what the call ends with; nullopt: not yet. OK takes effect when all
  // notifications are written.
  void EndIfIdle(const Pending& pending, const std::function<std::optional<absl::Status>()>& end_of_input);
  // The write to begin, or that the call is to be finished now with end().
  Output NextOutput(const Pending& pending);
  // The task to begin; none unless is_due().
  Task NextTask(const Pending& pending);
  bool NextRead(const Pending& pending);  // true: a read is to begin

  bool is_writing() const { return is_writing_; }
  bool has_ended() const { return end_.has_value(); }
  bool is_finished() const { return is_finished_; }  // finishing is under way or done: the stream is not to be touched
  const absl::Status& end() const { return *end_; }  // precondition: has_ended()

 private:
  bool is_reading_ = false;
  bool is_working_ = false;
  bool is_writing_ = false;
  bool notifications_due_ = false;
  bool is_draining_ = false;
  bool is_interrupted_ = false;
  bool is_finished_ = false;
  std::optional<absl::Status> input_end_;
  std::optional<absl::Status> end_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_RPC_STREAM_STATE_H_
