// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The streaming of a call that brings bytes in chunks: while the disk pool works on some messages, the next few are
// being read, and no more than that. Answers to them go back, and with them what is told unasked, which is called news
// here. An idle stream holds no thread and next to no memory.
#ifndef CURVEREG_SERVER_RPC_CHUNK_STREAM_H_
#define CURVEREG_SERVER_RPC_CHUNK_STREAM_H_

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include <algorithm>
#include <cstddef>
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
#include "server/scheduling/worker_pool.h"
#include "wire/error.h"

namespace curvereg::server {

// Reactions of gRPC, the end of a task, a wake, a takeover and the server's draining are events: each changes the state
// under the mutex and calls Advance, the one place that starts anything.
//
// Life: the object deletes itself in OnDone, which gRPC calls after Finish and after the reactions to all reads and
// writes. Finish is called once, when no task is out and nothing is being written; whoever calls it touches the object
// no more. Wake, takeover and draining may come until the destructor is through: then they find the call finished.
template <typename Request, typename Response>
class ChunkStream : public grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer> {
 public:
  // `disk_pool` outlives the call.
  ChunkStream(const CallEnvironment& calls, const MethodTraits& traits, WorkerPool& disk_pool,
              grpc::CallbackServerContext& context)
      : context_(context), disk_pool_(disk_pool), draining_(calls.draining), call_(calls, traits, context) {}

  void OnReadDone(bool ok) final {
    // While reading_, nobody else looks at these.
    const bool is_readable = ok && Parse(received_, arriving_);
    received_.Clear();
    std::unique_lock lock(mutex_);
    reading_ = false;
    if (is_readable) {
      call_.CountReceived();
      arrived_.push_back(std::exchange(arriving_, {}));
    } else if (ok) {
      // The messages before still count.
      input_end_ = wire::MakeError(v1::ERROR_REASON_UNEXPECTED_MESSAGE, "a message was not readable");
    } else {
      input_end_ = context_.IsCancelled() ? CallerIsGone() : absl::OkStatus();
    }
    Advance(std::move(lock));
  }

  void OnWriteDone(bool ok) final {
    std::unique_lock lock(mutex_);
    writing_ = false;
    if (!ok) Interrupt(CallerIsGone());
    Advance(std::move(lock));
  }

  void OnCancel() final {
    {
      const std::lock_guard lock(mutex_);
      Interrupt(CallerIsGone());
    }
    // Drops a task that waits, on this thread, which comes back by OnWorked.
    call_.Cancel();
    Advance(std::unique_lock(mutex_));
  }

  void OnDone() final { delete this; }

 protected:
  virtual ~ChunkStream() = default;

  // False: not a request.
  virtual bool Parse(grpc::ByteBuffer& bytes, Request& request) const = 0;
  virtual bool IsChunk(const Request& request) const = 0;

  // The task, one at a time: does what the request asks; the answer, if there is one. An error ends the call, after the
  // answers to the requests before.
  virtual absl::StatusOr<std::optional<Response>> Handle(Request& request) = 0;
  // After it, when woken: adds the next few news; none: there are none before the next wake.
  virtual absl::Status TakeNews(std::vector<Response>& /*news*/) { return absl::OkStatus(); }

  // Between tasks; must not block. The older answer, not written yet, need not be told.
  virtual bool Supersedes(const Response& newer, const Response& older) const = 0;
  // The last answer was the last thing to do: the call ends OK, whatever else comes in.
  virtual bool IsDone() const { return false; }
  // The client has ended its side and all of it was handled: what the call ends with; nullopt: not yet. OK counts when
  // all news are written.
  virtual std::optional<absl::Status> EndOfInput() const = 0;

  // Last thing in the constructor of the derived class.
  void Begin() {
    {
      const std::lock_guard lock(mutex_);
      if (!call_.admitted().ok()) End(call_.admitted());
    }
    on_replaced_.emplace(replaced_.get_token(), [this] { OnReplaced(); });
    on_draining_.emplace(draining_, [this] { Advance(std::unique_lock(mutex_)); });
    Advance(std::unique_lock(mutex_));
  }

  // There may be news.
  void Wake() {
    std::unique_lock lock(mutex_);
    news_due_ = true;
    Advance(std::move(lock));
  }

  // To be requested to stop by the stream that takes over.
  const std::stop_source& replaced() const { return replaced_; }

 private:
  // Messages read ahead: enough that neither the disk nor the link waits for the other at every chunk.
  static constexpr std::size_t kMostWaiting = 3;
  // Answers that the client has not taken; beyond it nothing more is done for it.
  static constexpr std::size_t kMostAnswers = 16;

  absl::Status Work() {
    absl::Status status = HandleTaken();
    // Chunks of streams that idle would add up.
    taken_.clear();
    return status.ok() && wants_news_ ? TakeNews(made_news_) : status;
  }

  absl::Status HandleTaken() {
    for (Request& request : taken_) {
      absl::StatusOr<std::optional<Response>> answer = Handle(request);
      if (!answer.ok()) return answer.status();
      if (answer->has_value()) Add(**std::move(answer), made_);
    }
    return absl::OkStatus();
  }

  void Add(Response answer, std::deque<Response>& answers) const {
    if (!answers.empty() && Supersedes(answer, answers.back())) answers.pop_back();
    answers.push_back(std::move(answer));
  }

  void OnWorked(const absl::Status& status) {
    std::unique_lock lock(mutex_);
    working_ = false;
    for (Response& answer : made_) Add(std::move(answer), answers_);
    made_.clear();
    // There may be more than were asked for.
    if (!made_news_.empty()) news_due_ = true;
    std::move(made_news_.begin(), made_news_.end(), std::back_inserter(news_));
    made_news_.clear();
    if (!status.ok() || IsDone()) End(status);
    Advance(std::move(lock));
  }

  void OnReplaced() {
    std::unique_lock lock(mutex_);
    // What ends already ends as it would have.
    if (!end_.has_value()) Interrupt(wire::MakeError(v1::ERROR_REASON_WRITER_REPLACED, "another stream took over"));
    Advance(std::move(lock));
  }

  // These with the mutex held. Advance gives the lock back.

  void End(const absl::Status& status) {  // the first reason counts
    if (!end_.has_value()) end_ = status;
  }

  void Interrupt(const absl::Status& status) {  // End, and nothing more is written
    End(status);
    interrupted_ = true;
  }

  void EndIfIdle() {
    if (working_ || !arrived_.empty()) return;
    if (input_end_.has_value()) {
      const std::optional<absl::Status> end = input_end_->ok() ? EndOfInput() : input_end_;
      if (end.has_value() && (!end->ok() || news_.empty())) End(*end);
    }
    if (draining_.stop_requested()) {
      End(wire::MakeError(v1::ERROR_REASON_NOT_SERVING, "the server is about to stop; what was acknowledged stays"));
    }
  }

  // For one task: the chunks in front, or one message of another kind, for its answer must be told; of chunks the last
  // answer is enough.
  void TakeArrived() {
    auto end = std::find_if_not(arrived_.begin(), arrived_.end(), [&](const Request& r) { return IsChunk(r); });
    if (end == arrived_.begin()) ++end;
    taken_.assign(std::make_move_iterator(arrived_.begin()), std::make_move_iterator(end));
    arrived_.erase(arrived_.begin(), end);
  }

  bool TakeWork() {  // for one task; false: there is nothing to do
    if (!arrived_.empty() && answers_.size() < kMostAnswers) TakeArrived();
    wants_news_ = news_due_ && news_.empty();
    if (wants_news_) news_due_ = false;
    return !taken_.empty() || wants_news_;
  }

  void PutFront(std::deque<Response>& responses) {  // into written_
    const grpc::Slice slice(responses.front().SerializeAsString());
    written_ = grpc::ByteBuffer(&slice, 1);
    responses.pop_front();
    call_.CountSent();
  }

  void Write() {  // the next answer or news, if there are any
    // Answers are told even when the call ends with an error; news can be asked for again.
    std::deque<Response>& responses = answers_.empty() && !end_.has_value() ? news_ : answers_;
    if (writing_ || interrupted_ || responses.empty()) return;
    PutFront(responses);
    writing_ = true;
    StartWrite(&written_);
  }

  void Advance(std::unique_lock<std::mutex> lock) {
    if (finished_) return;
    EndIfIdle();
    const bool is_over = end_.has_value() && !working_ && !writing_;
    const bool is_last_answer = is_over && end_->ok() && answers_.size() == 1;
    if (is_over && (interrupted_ || answers_.empty() || is_last_answer)) {
      FinishCall(std::move(lock));
      return;
    }
    Write();
    if (end_.has_value()) return;  // what is still out comes back here
    const bool work = !working_ && TakeWork();
    working_ = working_ || work;
    if (!reading_ && arrived_.size() < kMostWaiting && !input_end_.has_value()) {
      reading_ = true;
      StartRead(&received_);
    }
    lock.unlock();
    // Without the lock, for the task may be refused or dropped at once. Until OnWorked nobody finishes the call.
    if (work) {
      RunOnPool(disk_pool_, call_,
                {[this] { return Work(); }, [this](const absl::Status& status) { OnWorked(status); }});
    }
  }

  void FinishCall(std::unique_lock<std::mutex> lock) {
    finished_ = true;
    const grpc::Status status = call_.Finish(*end_);
    const bool has_answer = !interrupted_ && !answers_.empty();
    if (has_answer) PutFront(answers_);
    lock.unlock();
    if (has_answer) {
      StartWriteAndFinish(&written_, grpc::WriteOptions(), status);
    } else {
      Finish(status);
    }
  }

  grpc::CallbackServerContext& context_;
  WorkerPool& disk_pool_;
  const std::stop_token draining_;
  Call call_;

  std::mutex mutex_;
  bool reading_ = false;                   // into received_ and arriving_
  bool working_ = false;                   // a task is out; taken_, wants_news_, made_, made_news_ are its own
  bool writing_ = false;                   // written_
  bool interrupted_ = false;               // nothing more is written
  bool finished_ = false;                  // Finish was called, or is about to be
  bool news_due_ = false;                  // there may be news that we have not got
  std::optional<absl::Status> input_end_;  // no more is read; OK: the client is done
  std::optional<absl::Status> end_;        // nothing new is begun
  grpc::ByteBuffer received_;
  Request arriving_;
  std::vector<Request> arrived_;  // no task has taken them yet
  std::deque<Response> answers_;  // to be written, before news
  std::deque<Response> news_;     // to be written
  grpc::ByteBuffer written_;

  std::vector<Request> taken_;
  bool wants_news_ = false;
  std::deque<Response> made_;
  std::vector<Response> made_news_;

  const std::stop_source replaced_;
  // Last, so that they are gone before what they use.
  std::optional<std::stop_callback<std::function<void()>>> on_replaced_;
  std::optional<std::stop_callback<std::function<void()>>> on_draining_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_RPC_CHUNK_STREAM_H_
