// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The streaming of a call with one request and many answers: while one answer is being written a worker makes the next,
// or the next few, and no more than that. An idle stream holds no thread and next to no memory.
#ifndef CURVEREG_SERVER_RPC_RESPONSE_STREAM_H_
#define CURVEREG_SERVER_RPC_RESPONSE_STREAM_H_

#include <grpcpp/support/server_callback.h>

#include <deque>
#include <mutex>
#include <optional>
#include <utility>

#include "absl/status/statusor.h"
#include "server/rpc/call.h"
#include "server/rpc/call_task.h"
#include "server/rpc/stream_state.h"
#include "server/scheduling/worker_pool.h"

namespace curvereg::server {

// Reactions of gRPC, the end of a task and a wake are events: each changes the state under the mutex and calls Advance,
// the one place that starts anything.
//
// Life: the object deletes itself in OnDone, which gRPC calls after Finish and after the reactions to all writes.
// Whoever calls Finish touches the object no more. Wake and Interrupt may come at any time before the destructor of the
// derived class is through with its members.
template <typename Response>
class ResponseStream : public grpc::ServerWriteReactor<Response> {
 public:
  ResponseStream(const CallEnvironment& calls, const MethodTraits& traits, grpc::CallbackServerContext& context)
      : call_(calls, traits, context) {
    call_.CountReceived();
    state_.EndInput(absl::OkStatus());  // the request came with the call
    state_.Notify();
  }

  void OnWriteDone(bool ok) final {
    std::unique_lock lock(mutex_);
    state_.WriteEnded();
    if (!ok) state_.Interrupt(CallerIsGone());
    Advance(std::move(lock));
  }

  void OnCancel() final {
    {
      const std::lock_guard lock(mutex_);
      state_.Interrupt(CallerIsGone());
    }
    // Drops a task that waits, on this thread, which comes back by OnWorked.
    call_.Cancel();
    Advance(std::unique_lock(mutex_));
  }

  void OnDone() final { delete this; }

 protected:
  // What there is to be expected after a task.
  enum class Next { kMore, kAfterWake, kEnd };

  virtual ~ResponseStream() = default;

  // The task, one at a time: adds its responses to `made`. Its error ends the stream, without what is in `made`.
  virtual absl::StatusOr<Next> Make(std::deque<Response>& made) = 0;
  // Where the next task goes. Called between tasks; must not block.
  virtual WorkerPool& pool() = 0;

  // Last thing in the constructor of the derived class.
  void Begin() {
    std::unique_lock lock(mutex_);
    if (!call_.admitted().ok()) state_.End(call_.admitted());
    Advance(std::move(lock));
  }

  // There may be more.
  void Wake() {
    std::unique_lock lock(mutex_);
    state_.Notify();
    Advance(std::move(lock));
  }

  // Ends the stream as soon as what is out has come back.
  void Interrupt(const absl::Status& status) {
    std::unique_lock lock(mutex_);
    state_.Interrupt(status);
    Advance(std::move(lock));
  }

  const Call& call() const { return call_; }

 private:
  absl::Status Work() {
    const absl::StatusOr<Next> next = Make(in_flight_);
    if (next.ok()) next_ = *next;
    return next.status();
  }

  void OnWorked(const absl::Status& status) {
    std::unique_lock lock(mutex_);
    state_.TaskEnded(status);
    if (status.ok()) {
      in_flight_.swap(pending_);
      if (next_ == Next::kMore) state_.Notify();
      is_complete_ = next_ == Next::kEnd;
    }
    Advance(std::move(lock));
  }

  // With the mutex held, which is given back.
  void Advance(std::unique_lock<std::mutex> lock) {
    if (state_.is_finished()) return;
    // Only after the last write, which may fail.
    const bool is_done = is_complete_ && !state_.is_writing();
    state_.EndIfIdle(Queued(), [is_done] { return is_done ? std::optional(absl::OkStatus()) : std::nullopt; });
    const StreamState::Output output = state_.NextOutput(Queued());
    if (output == StreamState::Output::kFinish) {
      const grpc::Status status = call_.Finish(state_.end());
      lock.unlock();
      this->Finish(status);
      return;
    }
    if (output == StreamState::Output::kNotification) {
      written_ = std::move(pending_.front());
      pending_.pop_front();
      call_.CountSent();
      this->StartWrite(&written_);
    }
    if (!state_.NextTask(Queued()).is_due()) return;
    WorkerPool& next_pool = pool();
    lock.unlock();
    // Without the lock, for the task may be refused or dropped at once. The call is not finished before OnWorked.
    RunOnPool(next_pool, call_, {[this] { return Work(); }, [this](const absl::Status& status) { OnWorked(status); }});
  }

  StreamState::Pending Queued() const { return {.num_notifications = pending_.size()}; }

  Call call_;
  std::mutex mutex_;
  StreamState state_;
  std::deque<Response> pending_;  // to be written
  Response written_;
  bool is_complete_ = false;  // nothing more is made
  // Of the task, while one is under way; empty between tasks.
  std::deque<Response> in_flight_;
  Next next_ = Next::kMore;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_RPC_RESPONSE_STREAM_H_
