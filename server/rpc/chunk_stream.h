// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The streaming of a call that brings bytes in chunks: while the disk pool works on some requests, the next few are
// being read, and no more than that. Answers to them go back, and notifications, which the server sends by itself. An
// idle stream holds no thread and next to no memory.
#ifndef CURVEREG_SERVER_RPC_CHUNK_STREAM_H_
#define CURVEREG_SERVER_RPC_CHUNK_STREAM_H_

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include <algorithm>
#include <deque>
#include <functional>
#include <iterator>
#include <mutex>
#include <optional>
#include <stop_token>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "server/rpc/call.h"
#include "server/rpc/call_task.h"
#include "server/rpc/stream_session.h"
#include "server/rpc/stream_state.h"
#include "server/scheduling/worker_pool.h"
#include "wire/error.h"

namespace curvereg::server {

// Reactions of gRPC, the end of a task, a wake, a takeover and the server's draining are events: each changes the state
// under the mutex and calls Advance, the one place that starts anything.
//
// Life: the object deletes itself in OnDone, which gRPC calls after Finish and after the reactions to all reads and
// writes. Whoever calls Finish touches the object no more. Wake, takeover and draining may come until the destructor is
// through: then they find the call finished.
template <StreamSession Session>
class ChunkStream final : public grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer> {
 public:
  // Everything in it outlives the call.
  struct Environment {
    CallEnvironment calls;
    typename Session::Environment session;
    WorkerPool* disk_pool = nullptr;
  };

  ChunkStream(const Environment& environment, const MethodTraits& traits, grpc::CallbackServerContext& context)
      : context_(context),
        disk_pool_(*environment.disk_pool),
        call_(environment.calls, traits, context),
        session_(environment.session, {.replaced = replaced_, .wake = [this] { Wake(); }}) {
    if (!call_.admitted().ok()) state_.End(call_.admitted());
    on_replaced_.emplace(replaced_.get_token(), [this] { OnReplaced(); });
    on_draining_.emplace(environment.calls.draining, [this] { OnDraining(); });
    Advance(std::unique_lock(mutex_));
  }

  void OnReadDone(bool ok) override {
    // While a read is under way, no other thread uses these.
    const bool is_readable = ok && Session::Parse(received_, arriving_);
    received_.Clear();
    std::unique_lock lock(mutex_);
    state_.ReadEnded();
    if (is_readable) {
      call_.CountReceived();
      requests_.push_back(std::exchange(arriving_, {}));
    } else if (ok) {
      // The requests before still count.
      state_.EndInput(wire::MakeError(v1::ERROR_REASON_UNEXPECTED_MESSAGE, "a message was not readable"));
    } else {
      state_.EndInput(context_.IsCancelled() ? CallerIsGone() : absl::OkStatus());
    }
    Advance(std::move(lock));
  }

  void OnWriteDone(bool ok) override {
    std::unique_lock lock(mutex_);
    state_.WriteEnded();
    if (!ok) state_.Interrupt(CallerIsGone());
    Advance(std::move(lock));
  }

  void OnCancel() override {
    {
      const std::lock_guard lock(mutex_);
      state_.Interrupt(CallerIsGone());
    }
    // Drops a task that waits, on this thread, which comes back by OnWorked.
    call_.Cancel();
    Advance(std::unique_lock(mutex_));
  }

  void OnDone() override { delete this; }

 private:
  using Request = typename Session::Request;
  using Response = typename Session::Response;

  // A task: what it works on and what it makes. Its own while it is under way, empty between tasks.
  struct InFlight {
    std::vector<Request> requests;
    bool takes_notifications = false;
    std::deque<Response> answers;
    std::vector<Response> notifications;
  };

  ~ChunkStream() override = default;

  void Wake() {
    std::unique_lock lock(mutex_);
    state_.Notify();
    Advance(std::move(lock));
  }

  void OnReplaced() {
    std::unique_lock lock(mutex_);
    // What ends already ends as it would have.
    if (!state_.has_ended()) {
      state_.Interrupt(wire::MakeError(v1::ERROR_REASON_WRITER_REPLACED, "another stream took over"));
    }
    Advance(std::move(lock));
  }

  void OnDraining() {
    std::unique_lock lock(mutex_);
    state_.Drain();
    Advance(std::move(lock));
  }

  absl::Status Work() {
    absl::Status status = HandleRequests();
    // Chunks of streams that idle would add up.
    in_flight_.requests.clear();
    return status.ok() && in_flight_.takes_notifications ? session_.TakeNotifications(in_flight_.notifications)
                                                         : status;
  }

  absl::Status HandleRequests() {
    for (Request& request : in_flight_.requests) {
      absl::StatusOr<std::optional<Response>> answer = session_.Handle(request);
      if (!answer.ok()) return answer.status();
      if (answer->has_value()) AddAnswer(**std::move(answer), in_flight_.answers);
    }
    return absl::OkStatus();
  }

  static void AddAnswer(Response answer, std::deque<Response>& answers) {
    if (!answers.empty() && Session::Supersedes(answer, answers.back())) answers.pop_back();
    answers.push_back(std::move(answer));
  }

  void OnWorked(const absl::Status& status) {
    std::unique_lock lock(mutex_);
    state_.TaskEnded(status);
    for (Response& answer : in_flight_.answers) AddAnswer(std::move(answer), answers_);
    in_flight_.answers.clear();
    // There may be more than were asked for.
    if (!in_flight_.notifications.empty()) state_.Notify();
    std::move(in_flight_.notifications.begin(), in_flight_.notifications.end(), std::back_inserter(notifications_));
    in_flight_.notifications.clear();
    if (session_.is_done()) state_.End(absl::OkStatus());
    Advance(std::move(lock));
  }

  // These with the mutex held. Advance gives the lock back.

  StreamState::Pending Queued() const {
    return {
        .num_requests = requests_.size(), .num_answers = answers_.size(), .num_notifications = notifications_.size()};
  }

  // For one task: the chunks in front, of which the last answer is enough, or one request of another kind.
  void TakeRequests() {
    auto end = std::find_if_not(requests_.begin(), requests_.end(), &Session::IsChunk);
    if (end == requests_.begin()) ++end;
    in_flight_.requests.assign(std::make_move_iterator(requests_.begin()), std::make_move_iterator(end));
    requests_.erase(requests_.begin(), end);
  }

  void PutFront(std::deque<Response>& responses) {  // into written_
    const grpc::Slice slice(responses.front().SerializeAsString());
    written_ = grpc::ByteBuffer(&slice, 1);
    responses.pop_front();
    call_.CountSent();
  }

  void Advance(std::unique_lock<std::mutex> lock) {
    if (state_.is_finished()) return;
    state_.EndIfIdle(Queued(), [this] { return session_.EndOfInput(); });
    const StreamState::Output output = state_.NextOutput(Queued());
    if (state_.is_finished()) {
      FinishCall(output == StreamState::Output::kFinishWithLastAnswer, std::move(lock));
      return;
    }
    if (output != StreamState::Output::kNothing) {
      PutFront(output == StreamState::Output::kAnswer ? answers_ : notifications_);
      StartWrite(&written_);
    }
    const StreamState::Task task = state_.NextTask(Queued());
    if (task.handles_requests) TakeRequests();
    if (task.is_due()) in_flight_.takes_notifications = task.takes_notifications;
    if (state_.NextRead(Queued())) StartRead(&received_);
    lock.unlock();
    // Without the lock, for the task may be refused or dropped at once. The call is not finished before OnWorked.
    if (task.is_due()) {
      RunOnPool(disk_pool_, call_,
                {[this] { return Work(); }, [this](const absl::Status& status) { OnWorked(status); }});
    }
  }

  void FinishCall(bool with_last_answer, std::unique_lock<std::mutex> lock) {
    const grpc::Status status = call_.Finish(state_.end());
    if (with_last_answer) PutFront(answers_);
    lock.unlock();
    if (with_last_answer) {
      StartWriteAndFinish(&written_, grpc::WriteOptions(), status);
    } else {
      Finish(status);
    }
  }

  grpc::CallbackServerContext& context_;
  WorkerPool& disk_pool_;
  Call call_;

  std::mutex mutex_;
  StreamState state_;
  grpc::ByteBuffer received_;
  Request arriving_;
  std::vector<Request> requests_;
  std::deque<Response> answers_;
  std::deque<Response> notifications_;
  grpc::ByteBuffer written_;
  InFlight in_flight_;

  const std::stop_source replaced_;
  // Last, so that these are gone before what they use: the session may wake the stream until it is destroyed.
  Session session_;
  std::optional<std::stop_callback<std::function<void()>>> on_replaced_;
  std::optional<std::stop_callback<std::function<void()>>> on_draining_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_RPC_CHUNK_STREAM_H_
