// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/traverses/scan_stream.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "curvereg/v1/traverse_service.grpc.pb.h"
#include "server/scans/disk_task.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

// Messages read ahead: enough that neither the disk nor the link waits for the other at every chunk.
constexpr std::size_t kMostWaiting = 3;
// Answers that the client has not taken; beyond it nothing more is done for it.
constexpr std::size_t kMostAnswers = 16;
constexpr int kMostResults = 8;  // read at once

constexpr MethodTraits kTraits = {v1::TraverseService::service_full_name(), "StreamScans", Scope::kWrite};

bool Parse(grpc::ByteBuffer& buffer, v1::StreamScansRequest& request) {
  return grpc::SerializationTraits<v1::StreamScansRequest>::Deserialize(&buffer, &request).ok();
}

}  // namespace

ScanStream::ScanStream(const Environment& environment, grpc::CallbackServerContext& context)
    : environment_(environment),
      context_(context),
      call_(environment.calls, kTraits, context),
      session_(environment.session, replaced_, [this] { OnWake(); }),
      on_replaced_(replaced_.get_token(), [this] { OnReplaced(); }),
      on_draining_(environment.calls.draining, [this] { Advance(std::unique_lock(mutex_)); }) {
  std::unique_lock lock(mutex_);
  if (!call_.admitted().ok()) End(call_.admitted());
  Advance(std::move(lock));
}

void ScanStream::OnReadDone(bool ok) {
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

void ScanStream::OnWriteDone(bool ok) {
  std::unique_lock lock(mutex_);
  writing_ = false;
  if (!ok) Interrupt(CallerIsGone());
  Advance(std::move(lock));
}

void ScanStream::OnCancel() {
  {
    const std::lock_guard lock(mutex_);
    Interrupt(CallerIsGone());
  }
  // Drops a task that waits, on this thread, which comes back by OnWorked.
  call_.Cancel();
  Advance(std::unique_lock(mutex_));
}

void ScanStream::OnReplaced() {
  std::unique_lock lock(mutex_);
  Interrupt(wire::MakeError(v1::ERROR_REASON_WRITER_REPLACED, "another stream took the traverse over"));
  Advance(std::move(lock));
}

void ScanStream::OnWake() {
  std::unique_lock lock(mutex_);
  results_due_ = true;
  Advance(std::move(lock));
}

absl::Status ScanStream::Work() {
  absl::Status status = Handle();
  // Chunks of streams that idle would add up.
  taken_.clear();
  if (!status.ok() || !wants_results_) return status;
  absl::StatusOr<std::vector<v1::ScanResult>> found = session_.TakeResults(kMostResults);
  if (found.ok()) found_ = *std::move(found);
  return found.status();
}

absl::Status ScanStream::Handle() {
  for (v1::StreamScansRequest& request : taken_) {
    absl::StatusOr<std::optional<v1::StreamScansResponse>> answer = session_.Handle(request);
    if (!answer.ok()) return answer.status();
    if (answer->has_value()) worked_ = *std::move(answer);
  }
  return absl::OkStatus();
}

void ScanStream::OnWorked(const absl::Status& status) {
  std::unique_lock lock(mutex_);
  working_ = false;
  if (worked_.has_value()) {
    // The latest offset is enough.
    const bool is_newer = !answers_.empty() && answers_.back().has_ack() && !answers_.back().ack().complete() &&
                          answers_.back().ack().sequence_number() == worked_->ack().sequence_number();
    if (is_newer) answers_.pop_back();
    // From now on nothing of a traverse is missed.
    if (worked_->has_ready()) results_due_ = true;
    answers_.push_back(*std::exchange(worked_, std::nullopt));
  }
  // There may be more than were asked for.
  if (!found_.empty()) results_due_ = true;
  results_.insert(results_.end(), std::make_move_iterator(found_.begin()), std::make_move_iterator(found_.end()));
  found_.clear();
  if (!status.ok()) End(status);
  Advance(std::move(lock));
}

void ScanStream::End(const absl::Status& status) {
  if (!end_.has_value()) end_ = status;
}

void ScanStream::Interrupt(const absl::Status& status) {
  End(status);
  answers_.clear();
}

void ScanStream::EndIfIdle() {
  if (working_ || !arrived_.empty()) return;
  if (input_end_.has_value() && !input_end_->ok()) {
    End(*input_end_);
  } else if (input_end_.has_value() && !(session_.has_started() && session_.is_between_scans())) {
    End(wire::MakeError(v1::ERROR_REASON_UNEXPECTED_MESSAGE, "the stream ended before the last byte of a scan"));
  } else if (input_end_.has_value() && results_.empty() && session_.took_all_results()) {
    End(absl::OkStatus());
  } else if (environment_.calls.draining.stop_requested()) {
    End(wire::MakeError(v1::ERROR_REASON_NOT_SERVING, "the server is about to stop; what is acknowledged stays"));
  }
}

void ScanStream::TakeArrived() {
  const auto is_chunk = [](const v1::StreamScansRequest& request) { return request.has_chunk(); };
  auto end = std::find_if_not(arrived_.begin(), arrived_.end(), is_chunk);
  // Alone, for its answer must be told; of chunks the last answer is enough.
  if (end == arrived_.begin()) ++end;
  taken_.assign(std::make_move_iterator(arrived_.begin()), std::make_move_iterator(end));
  arrived_.erase(arrived_.begin(), end);
}

bool ScanStream::TakeWork() {
  if (!arrived_.empty() && answers_.size() < kMostAnswers) TakeArrived();
  wants_results_ = results_due_ && results_.empty();
  if (wants_results_) results_due_ = false;
  return !taken_.empty() || wants_results_;
}

void ScanStream::Write() {
  v1::StreamScansResponse response;
  if (!answers_.empty()) {
    response = std::move(answers_.front());
    answers_.pop_front();
  } else {
    *response.mutable_result() = std::move(results_.front());
    results_.pop_front();
  }
  written_ = SerializedResponse(response);
  writing_ = true;
  call_.CountSent();
  StartWrite(&written_);
}

void ScanStream::Advance(std::unique_lock<std::mutex> lock) {
  if (finished_) return;
  EndIfIdle();
  // Acknowledgements are told even when the stream ends with an error; results can be asked for again.
  if (!writing_ && (!answers_.empty() || (!end_.has_value() && !results_.empty()))) Write();
  if (end_.has_value()) {
    // What is still out comes back here.
    if (working_ || writing_) return;
    finished_ = true;
    const grpc::Status status = call_.Finish(*end_);
    lock.unlock();
    grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>::Finish(status);
    return;
  }
  const bool work = !working_ && TakeWork();
  working_ = working_ || work;
  if (!reading_ && arrived_.size() < kMostWaiting && !input_end_.has_value()) {
    reading_ = true;
    StartRead(&received_);
  }
  lock.unlock();
  // Without the lock, for the task may be refused or dropped at once. Until OnWorked nobody finishes the call.
  if (work) {
    RunOnDiskPool(*environment_.disk_pool, call_,
                  {[this] { return Work(); }, [this](const absl::Status& status) { OnWorked(status); }});
  }
}

}  // namespace curvereg::server
