// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/upload_stream.h"

#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/impl/codegen/proto_utils.h>

#include <algorithm>
#include <utility>

#include "client/retry.h"

namespace curvereg::internal {
namespace {

using Clock = std::chrono::steady_clock;

constexpr char kMethod[] = "/curvereg.v1.ScanService/UploadScan";
// Of progress and of the server's silence. Told at the last acknowledgement but not at each: on a quick link these are
// so many that waking the caller for them would take the processor from the transfer.
constexpr std::chrono::milliseconds kPollInterval(20);

}  // namespace

UploadStream::UploadStream(const UploadSource& source, const UploadState& state, const UploadWindow::Options& window)
    : source_(source), begun_at_(state.committed), state_(state), window_(window), last_answer_(Clock::now()) {}

absl::Status UploadStream::Run(Connection& connection, const std::shared_ptr<grpc::Channel>& channel,
                               const Limits& limits, const std::function<void(const UploadState&)>& on_progress) {
  connection.Prepare(context_);
  grpc::TemplatedGenericStub<grpc::ByteBuffer, v1::UploadScanResponse> stub(channel);
  stub.PrepareBidiStreamingCall(&context_, kMethod, {}, this);
  v1::UploadScanRequest request;
  *request.mutable_start() = source_.start;
  message_ = SerializedRequest(request);
  StartRead(&response_);
  StartWrite(&message_);
  StartCall();
  const bool silent = Await(limits, on_progress);
  if (limits.cancellation.stop_requested() && !state_.done) return absl::CancelledError("cancelled by the caller");
  if (state_.done) return absl::OkStatus();
  if (nonsense_) return absl::InternalError("the server's answers to an upload do not fit together");
  if (ended_->ok()) return absl::UnavailableError("the server ended the upload's stream early");
  if (silent) return absl::UnavailableError("the server has fallen silent");
  return CallError(*ended_, context_);
}

bool UploadStream::Await(const Limits& limits, const std::function<void(const UploadState&)>& on_progress) {
  const std::stop_callback cancel(limits.cancellation, [&] { context_.TryCancel(); });
  std::unique_lock lock(mutex_);
  const uint64_t payload_bytes = source_.payload.bytes.size();
  uint64_t told = begun_at_;
  bool silent = false;
  do {  // at least once: a short stream may have ended by now, and its progress counts
    changed_.wait_for(lock, kPollInterval,
                      [&] { return ended_ || (state_.committed != told && state_.committed == payload_bytes); });
    if (state_.committed != told) {
      told = state_.committed;
      const UploadState snapshot = state_;
      lock.unlock();
      on_progress(snapshot);
      lock.lock();
    }
    const std::chrono::milliseconds patience = finish_sent_ ? limits.finish_silence : limits.silence;
    if (ended_ || silent || Clock::now() - last_answer_ <= patience) continue;
    silent = true;
    context_.TryCancel();
  } while (!ended_ || state_.committed != told);
  return silent;
}

void UploadStream::OnReadDone(bool ok) {
  if (!ok) return;
  bool go_on = false;
  {
    const std::lock_guard lock(mutex_);
    last_answer_ = Clock::now();
    nonsense_ = !Take(response_);
    go_on = !nonsense_;
  }
  if (!go_on) {
    context_.TryCancel();
    return;
  }
  SendNext();
  StartRead(&response_);
}

bool UploadStream::Take(const v1::UploadScanResponse& response) {
  switch (response.message_case()) {
    case v1::UploadScanResponse::kReady:
      return TakeReady(response.ready());
    case v1::UploadScanResponse::kProgress:
      return ready_ && TakeCommitted(response.progress().committed_offset());
    case v1::UploadScanResponse::kDone:
      state_.done = response.done();
      state_.committed = source_.payload.bytes.size();
      return true;
    case v1::UploadScanResponse::MESSAGE_NOT_SET:
      return false;
  }
  return false;
}

bool UploadStream::TakeReady(const v1::UploadScanReady& ready) {
  if (ready_ || ready.committed_offset() > source_.payload.bytes.size()) return false;
  ready_ = true;
  offset_ = ready.committed_offset();
  // May lie before what was acknowledged: a server that lost its disk, say. Then that is sent again.
  state_.committed = offset_;
  max_chunk_bytes_ = ready.max_chunk_bytes() == 0 ? UINT32_MAX : ready.max_chunk_bytes();
  if (offset_ > state_.sent_end) state_.has_others_bytes = true;
  if (state_.sent_end > offset_) state_.bytes_resent += state_.sent_end - offset_;
  return true;
}

bool UploadStream::TakeCommitted(uint64_t committed) {
  if (committed < state_.committed || committed > offset_) return false;
  state_.committed = committed;
  window_.Acknowledged(committed, last_answer_);
  if (committed == source_.payload.bytes.size()) changed_.notify_one();
  return true;
}

void UploadStream::SendNext() {
  uint64_t begin = 0;
  uint64_t size = 0;
  UploadPayload payload = source_.payload;
  {
    const std::lock_guard lock(mutex_);
    if (writing_ || !ready_ || finish_sent_ || state_.done) return;
    begin = offset_;
    const uint64_t payload_bytes = source_.payload.bytes.size();
    if (begin < payload_bytes) {
      size = std::min(window_.NextChunkBytes(begin, state_.committed, payload_bytes), max_chunk_bytes_);
      if (size == 0) return;
      offset_ += size;
      state_.sent_end = std::max(state_.sent_end, offset_);
      window_.Sent(offset_, Clock::now());
    } else {
      finish_sent_ = true;
    }
    writing_ = true;
    // A caller of borrowed bytes waits, on a broken link, until gRPC notices that. So only where a copy would cost
    // time.
    if (!window_.IsWideOpen()) payload.borrowed = nullptr;
  }
  // Only one message is under way at a time, so message_ is ours here.
  if (size > 0) {
    message_ = SerializedChunk(payload, begin, size);
    StartWrite(&message_);
    return;
  }
  v1::UploadScanRequest request;
  request.mutable_finish();
  message_ = SerializedRequest(request);
  StartWriteLast(&message_, grpc::WriteOptions());
}

void UploadStream::OnWriteDone(bool ok) {
  {
    const std::lock_guard lock(mutex_);
    writing_ = false;
  }
  if (ok) SendNext();
}

void UploadStream::OnDone(const grpc::Status& status) {
  const std::lock_guard lock(mutex_);
  ended_ = status;
  changed_.notify_one();
}

}  // namespace curvereg::internal
