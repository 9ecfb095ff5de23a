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
#include "server/scheduling/worker_pool.h"

namespace curvereg::server {

// Reactions of gRPC, the end of a task and a wake are events: each changes the state under the mutex and calls Advance,
// the one place that starts anything.
//
// Life: the object deletes itself in OnDone, which gRPC calls after Finish and after the reactions to all writes.
// Finish is called once, when no task is out and nothing is being written; whoever calls it touches the object no more.
// Wake and Interrupt may come at any time before the destructor of the derived class is through with its members.
template <typename Response>
class ResponseStream : public grpc::ServerWriteReactor<Response> {
 public:
  ResponseStream(const CallEnvironment& calls, const MethodTraits& traits, grpc::CallbackServerContext& context)
      : call_(calls, traits, context) {
    call_.CountReceived();
  }

  void OnWriteDone(bool ok) final {
    std::unique_lock lock(mutex_);
    writing_ = false;
    if (!ok) End(CallerIsGone());
    Advance(std::move(lock));
  }

  void OnCancel() final {
    {
      const std::lock_guard lock(mutex_);
      End(CallerIsGone());
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

  // The task, one at a time: adds what it made to `made`. Its error ends the stream, without what is in `made`.
  virtual absl::StatusOr<Next> Make(std::deque<Response>& made) = 0;
  // Where the next task goes. Called between tasks; must not block.
  virtual WorkerPool& pool() = 0;

  // Last thing in the constructor of the derived class.
  void Begin() {
    std::unique_lock lock(mutex_);
    if (!call_.admitted().ok()) End(call_.admitted());
    Advance(std::move(lock));
  }

  // There may be more.
  void Wake() {
    std::unique_lock lock(mutex_);
    due_ = true;
    Advance(std::move(lock));
  }

  // Ends the stream as soon as what is out has come back.
  void Interrupt(const absl::Status& status) {
    std::unique_lock lock(mutex_);
    End(status);
    Advance(std::move(lock));
  }

  const Call& call() const { return call_; }

 private:
  absl::Status Work() {
    const absl::StatusOr<Next> next = Make(made_);
    if (next.ok()) next_ = *next;
    return next.status();
  }

  void OnWorked(const absl::Status& status) {
    std::unique_lock lock(mutex_);
    working_ = false;
    if (status.ok()) {
      made_.swap(ready_);
      due_ = due_ || next_ == Next::kMore;
      all_made_ = next_ == Next::kEnd;
    } else {
      End(status);
    }
    Advance(std::move(lock));
  }

  // These with the mutex held. Advance gives the lock back.
  void End(const absl::Status& status) {  // the first reason counts
    if (!end_.has_value()) end_ = status;
  }

  void Write() {
    writing_ = true;
    written_ = std::move(ready_.front());
    ready_.pop_front();
    call_.CountSent();
    this->StartWrite(&written_);
  }

  void Advance(std::unique_lock<std::mutex> lock) {
    if (!end_.has_value() && !writing_ && !ready_.empty()) Write();
    if (all_made_ && !writing_) End(absl::OkStatus());
    if (end_.has_value()) {
      // What is still out comes back here.
      if (working_ || writing_ || finished_) return;
      finished_ = true;
      const grpc::Status status = call_.Finish(*end_);
      lock.unlock();
      this->Finish(status);
      return;
    }
    if (working_ || !due_ || !ready_.empty() || all_made_) return;
    working_ = true;
    due_ = false;
    WorkerPool& next_pool = pool();
    lock.unlock();
    // Without the lock, for the task may be refused or dropped at once. Until OnWorked nobody finishes the call.
    RunOnPool(next_pool, call_, {[this] { return Work(); }, [this](const absl::Status& status) { OnWorked(status); }});
  }

  Call call_;
  std::mutex mutex_;
  bool due_ = true;        // there may be more to make
  bool all_made_ = false;  // nothing more is made
  bool working_ = false;   // a task is out; made_ and next_ are its own
  bool writing_ = false;   // written_
  bool finished_ = false;  // Finish was called, or is about to be
  std::optional<absl::Status> end_;
  std::deque<Response> ready_;  // to be written
  Response written_;
  std::deque<Response> made_;  // empty between tasks
  Next next_ = Next::kMore;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_RPC_RESPONSE_STREAM_H_
