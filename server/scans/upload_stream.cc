// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/scans/upload_stream.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "curvereg/v1/scan_service.grpc.pb.h"
#include "server/scans/disk_task.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

// Messages read ahead: enough that neither the disk nor the link waits for the other at every chunk.
constexpr std::size_t kMostWaiting = 3;

constexpr MethodTraits kTraits = {v1::ScanService::service_full_name(), "UploadScan", Scope::kWrite};

}  // namespace

UploadStream::UploadStream(const Environment& environment, grpc::CallbackServerContext& context)
    : environment_(environment),
      context_(context),
      call_(environment.calls, kTraits, context),
      session_(environment.uploads, replaced_),
      on_replaced_(replaced_.get_token(), [this] { OnReplaced(); }),
      on_draining_(environment.calls.draining, [this] { Advance(std::unique_lock(mutex_)); }) {
  std::unique_lock lock(mutex_);
  if (!call_.admitted().ok()) End(call_.admitted());
  Advance(std::move(lock));
}

void UploadStream::OnReadDone(bool ok) {
  // While reading_, nobody else looks at these.
  ok = ok && arriving_.Parse(received_);
  received_.Clear();
  std::unique_lock lock(mutex_);
  reading_ = false;
  if (ok) {
    call_.CountReceived();
    if (arriving_.request().has_finish()) input_end_ = absl::OkStatus();
    arrived_.push_back(std::exchange(arriving_, {}));
  } else {
    // The messages before still count, unless the caller is gone.
    input_end_ = context_.IsCancelled() ? CallerIsGone()
                                        : wire::MakeError(v1::ERROR_REASON_UNEXPECTED_MESSAGE,
                                                          "the stream ended, or was not readable, before finish");
  }
  Advance(std::move(lock));
}

void UploadStream::OnWriteDone(bool ok) {
  std::unique_lock lock(mutex_);
  writing_ = false;
  if (!ok) End(CallerIsGone());
  Advance(std::move(lock));
}

void UploadStream::OnCancel() {
  {
    const std::lock_guard lock(mutex_);
    End(CallerIsGone());
  }
  // Drops a task that waits, on this thread, which comes back by OnWorked.
  call_.Cancel();
  Advance(std::unique_lock(mutex_));
}

void UploadStream::OnReplaced() {
  std::unique_lock lock(mutex_);
  End(wire::MakeError(v1::ERROR_REASON_WRITER_REPLACED, "another stream took the upload over"));
  Advance(std::move(lock));
}

absl::Status UploadStream::Work() {
  for (UploadMessage& message : taken_) {
    worked_ = session_.Handle(message);
    if (!worked_.ok()) break;
  }
  // Chunks of streams that idle would add up.
  taken_.clear();
  return worked_.status();
}

void UploadStream::OnWorked(const absl::Status& status) {
  std::unique_lock lock(mutex_);
  working_ = false;
  if (!status.ok()) {
    End(status);
  } else {
    answer_ = *std::move(worked_);
    if (answer_->has_done()) End(absl::OkStatus());
  }
  Advance(std::move(lock));
}

void UploadStream::End(const absl::Status& status) {
  if (!end_.has_value()) end_ = status;
}

void UploadStream::EndIfIdle() {
  if (working_ || !arrived_.empty()) return;
  if (input_end_.has_value() && !input_end_->ok()) {
    End(*input_end_);
  } else if (environment_.calls.draining.stop_requested()) {
    End(wire::MakeError(v1::ERROR_REASON_NOT_SERVING, "the server is about to stop; what is committed stays"));
  }
}

void UploadStream::TakeArrived() {
  const auto is_chunk = [](const UploadMessage& message) { return message.request().has_chunk(); };
  auto end = std::find_if_not(arrived_.begin(), arrived_.end(), is_chunk);
  // Alone, for its answer must be told; of chunks the last answer is enough.
  if (end == arrived_.begin()) ++end;
  taken_.assign(std::make_move_iterator(arrived_.begin()), std::make_move_iterator(end));
  arrived_.erase(arrived_.begin(), end);
}

void UploadStream::Advance(std::unique_lock<std::mutex> lock) {
  EndIfIdle();
  if (end_.has_value()) {
    // What is still out comes back here.
    if (!working_ && !writing_ && !finished_) FinishCall(std::move(lock));
    return;
  }
  if (answer_.has_value() && !writing_) {
    written_ = SerializedResponse(*std::exchange(answer_, std::nullopt));
    writing_ = true;
    call_.CountSent();
    StartWrite(&written_);
  }
  const bool work = !arrived_.empty() && !working_;
  if (work) {
    working_ = true;
    TakeArrived();
  }
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

void UploadStream::FinishCall(std::unique_lock<std::mutex> lock) {
  finished_ = true;
  const grpc::Status status = call_.Finish(*end_);
  const bool is_done = end_->ok();
  if (is_done) {
    written_ = SerializedResponse(*std::exchange(answer_, std::nullopt));
    call_.CountSent();
  }
  lock.unlock();
  if (is_done) {
    StartWriteAndFinish(&written_, grpc::WriteOptions(), status);
  } else {
    Finish(status);
  }
}

}  // namespace curvereg::server
