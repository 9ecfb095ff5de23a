// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/traverse_stream.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/retry.h"
#include "curvereg/v1/traverse_service.grpc.pb.h"
#include "wire/digest.h"
#include "wire/error.h"

namespace curvereg::internal {
namespace {

// Of the server's silence. What is to be told or sent wakes the waiting thread by itself.
constexpr std::chrono::milliseconds kPollInterval(100);
// A stream that lives so long works: an idle one proves itself in no other way.
constexpr std::chrono::seconds kProof(1);
// For a server to end a stream on which all work is done.
constexpr std::chrono::seconds kFinishPatience(1);

}  // namespace

TraverseStream::TraverseStream(const std::string& traverse, TraverseSendQueue& queue)
    : queue_(queue), due_since_(Clock::now()) {
  message_.mutable_start()->set_traverse(traverse);
}

absl::Status TraverseStream::Run(Connection& connection, const std::shared_ptr<grpc::Channel>& channel,
                                 const Limits& limits, const std::function<void()>& tell,
                                 const std::function<void()>& on_alive) {
  {
    const std::lock_guard lock(queue_.mutex);
    queue_.pacer.Restart();
    if (queue_.last_result) message_.mutable_start()->set_last_result_sequence_number(*queue_.last_result);
  }
  connection.Prepare(context_);
  const auto stub = v1::TraverseService::NewStub(channel);
  stub->async()->StreamScans(&context_, this);
  AddHold();  // for what is sent from this thread
  StartRead(&response_);
  StartWrite(&message_);
  StartCall();
  {
    const std::stop_callback cancel(limits.cancellation, [this] { context_.TryCancel(); });
    Await(limits, tell, on_alive);
  }
  const std::lock_guard lock(queue_.mutex);
  return Outcome(limits);
}

absl::Status TraverseStream::Outcome(const Limits& limits) const {
  if (finished_at_ || queue_.IsDone()) return absl::OkStatus();
  if (limits.cancellation.stop_requested()) return absl::CancelledError("cancelled by the caller");
  if (!broken_.ok()) return broken_;
  if (silent_) return absl::UnavailableError("the server has fallen silent");
  if (ended_->ok()) return absl::UnavailableError("the server ended the stream of scans early");
  return CallError(*ended_, context_);
}

void TraverseStream::Await(const Limits& limits, const std::function<void()>& tell,
                           const std::function<void()>& on_alive) {
  std::unique_lock lock(queue_.mutex);
  bool held = true;
  while (!ended_ || queue_.has_notifications) {
    Clock::time_point wake = Clock::now() + kPollInterval;
    if (queue_.pacer.next_send() > Clock::now()) wake = std::min(wake, queue_.pacer.next_send());
    if (!queue_.has_notifications && !ended_) queue_.changed.wait_until(lock, wake);
    const bool alive =
        ready_at_ && !ended_ && (std::exchange(queue_.has_progress, false) || Clock::now() - *ready_at_ > kProof);
    const bool has_notifications = std::exchange(queue_.has_notifications, false);
    WatchSilence(limits.silence);
    const bool release = closed_ && std::exchange(held, false);
    lock.unlock();
    if (alive) on_alive();
    if (has_notifications) tell();
    if (release) {
      RemoveHold();
    } else if (held) {
      SendNext();
      EndWork();
    }
    lock.lock();
  }
}

bool TraverseStream::AnswerIsDue() const { return !ready_at_ || (!queue_.waiting.empty() && bytes_sent_ > 0); }

void TraverseStream::WatchSilence(std::chrono::milliseconds patience) {
  if (closed_ || silent_) return;
  const bool is_due = AnswerIsDue();
  if (is_due && !std::exchange(was_due_, is_due)) due_since_ = Clock::now();
  was_due_ = is_due;
  if (!is_due || Clock::now() - due_since_ <= patience) return;
  silent_ = true;
  context_.TryCancel();
}

void TraverseStream::EndWork() {
  bool finish = false;
  {
    const std::lock_guard lock(queue_.mutex);
    if (closed_) return;
    if (finished_at_ && Clock::now() - *finished_at_ > kFinishPatience) context_.TryCancel();
    finish = ready_at_ && !writing_ && !finished_at_ && queue_.IsDone();
    if (finish) finished_at_ = Clock::now();
  }
  if (finish) StartWritesDone();
}

void TraverseStream::OnReadDone(bool ok) {
  {
    const std::lock_guard lock(queue_.mutex);
    if (ok && broken_.ok()) {
      due_since_ = Clock::now();
      if (const absl::Status taken = Take(response_); !taken.ok()) Break(taken);
    }
    closed_ = !ok;
    if (!ok || queue_.has_notifications) queue_.changed.notify_all();
  }
  if (!ok) return;
  SendNext();
  StartRead(&response_);
}

void TraverseStream::Break(const absl::Status& why) {
  broken_ = why;
  context_.TryCancel();
}

absl::Status TraverseStream::Take(const v1::StreamScansResponse& response) {
  switch (response.message_case()) {
    case v1::StreamScansResponse::kReady:
      return TakeReady(response.ready());
    case v1::StreamScansResponse::kAck:
      return TakeAck(response.ack());
    case v1::StreamScansResponse::kResult: {
      const uint64_t wanted = queue_.last_result ? *queue_.last_result + 1 : 0;
      const uint64_t number = response.result().sequence_number();
      if (number < wanted) return absl::OkStatus();
      if (number > wanted) return absl::InternalError(absl::StrCat("the server left out the result of scan ", wanted));
      absl::StatusOr<curvereg::ScanResult> result = FromWire(response.result());
      if (!result.ok()) return result.status();
      queue_.results.push_back(*std::move(result));
      queue_.last_result = number;
      queue_.has_notifications = queue_.has_progress = true;
      return absl::OkStatus();
    }
    case v1::StreamScansResponse::MESSAGE_NOT_SET:
      break;
  }
  return absl::InternalError("the server's answers to a stream of scans do not fit together");
}

absl::Status TraverseStream::TakeReady(const v1::StreamScansReady& ready) {
  if (ready_at_) return absl::InternalError("the server said twice that it is ready for scans");
  ready_at_ = Clock::now();
  max_chunk_bytes_ = ready.max_chunk_bytes() == 0 ? UINT32_MAX : ready.max_chunk_bytes();
  if (queue_.greeted) ++queue_.progress.num_resumes;
  queue_.greeted = true;
  queue_.next_wanted = next_ = ready.next_sequence_number();
  queue_.DropBefore(next_, "");
  offset_ = ready.committed_offset();
  for (WaitingScan& scan : queue_.waiting) {
    const uint64_t kept = scan.sequence_number() == next_ ? offset_ : 0;
    // May be less than was acknowledged: a server that lost its disk, say. Then that is sent again.
    queue_.progress.bytes_acknowledged += kept - scan.committed;
    scan.committed = kept;
  }
  queue_.has_notifications = true;
  return absl::OkStatus();
}

absl::Status TraverseStream::TakeAck(const v1::StreamScansAck& ack) {
  if (!ready_at_) return absl::InternalError("the server acknowledged before it was ready");
  WaitingScan* scan = queue_.Find(ack.sequence_number());
  const bool is_under_way = scan != nullptr && (ack.sequence_number() < next_ || header_sent_);
  if (scan == nullptr && ack.sequence_number() < queue_.next_wanted) return absl::OkStatus();
  if (!is_under_way || ack.sequence_number() > next_ || ack.committed_offset() > scan->size()) {
    return absl::InternalError("the server acknowledged what was not sent");
  }
  const uint64_t committed = ack.complete() ? scan->size() : ack.committed_offset();
  queue_.pacer.Acknowledged(scan->begins_at + committed, due_since_);
  if (committed > scan->committed) {
    queue_.progress.bytes_acknowledged += committed - scan->committed;
    scan->committed = committed;
    queue_.has_progress = true;
  }
  if (!ack.complete()) return absl::OkStatus();
  // A scan that the server knows from elsewhere is complete before all of it was sent.
  if (ack.sequence_number() == next_) EndCursorScan();
  queue_.next_wanted = std::max(queue_.next_wanted, ack.sequence_number() + 1);
  queue_.has_progress = true;
  queue_.DropBefore(ack.sequence_number() + 1, ack.scan());
  return absl::OkStatus();
}

void TraverseStream::SendNext() {
  {
    const std::lock_guard lock(queue_.mutex);
    if (writing_ || !ready_at_ || closed_ || finished_at_ || !broken_.ok()) return;
    writing_ = MakeNext();
    if (!writing_) return;
  }
  StartWrite(&message_);  // only one message is under way at a time, so message_ is ours here
}

bool TraverseStream::MakeNext() {
  if (!queue_.waiting.empty() && next_ < queue_.waiting.front().sequence_number()) {
    Break(wire::MakeError(v1::ERROR_REASON_SEQUENCE_OUT_OF_RANGE,
                          absl::StrCat("the server expects scan ", next_, " next, but the first scan here is ",
                                       queue_.waiting.front().sequence_number()),
                          {{"next_sequence_number", absl::StrCat(next_)}}));
    return false;
  }
  WaitingScan* scan = queue_.Find(next_);
  if (scan == nullptr) return false;
  return header_sent_ ? MakeChunk(*scan) : MakeHeader(*scan);
}

bool TraverseStream::MakeHeader(WaitingScan& scan) {
  // Of another scan under this number, which was never acknowledged: the server drops it when it sees the header.
  if (offset_ > scan.size()) offset_ = 0;
  *message_.mutable_header() = scan.scan.header;
  scan.begins_at = bytes_sent_ - offset_;  // may wrap; only sums with offsets are looked at
  header_sent_ = true;
  if (offset_ == scan.size()) EndCursorScan();
  return true;
}

bool TraverseStream::MakeChunk(WaitingScan& scan) {
  const Clock::time_point now = Clock::now();
  const uint64_t size = std::min({queue_.pacer.NextChunkBytes(now), max_chunk_bytes_, scan.size() - offset_});
  if (size == 0) {
    if (queue_.pacer.next_send() > now) queue_.changed.notify_all();
    return false;
  }
  v1::PayloadChunk& chunk = *message_.mutable_chunk();
  chunk.set_offset(offset_);
  chunk.set_data(scan.scan.payload.data() + offset_, size);
  chunk.set_crc32c(wire::Crc32c(chunk.data()));
  if (offset_ < scan.sent_end) queue_.progress.bytes_resent += std::min(size, scan.sent_end - offset_);
  offset_ += size;
  bytes_sent_ += size;
  scan.sent_end = std::max(scan.sent_end, offset_);
  queue_.progress.bytes_sent += size;
  queue_.pacer.Sent(size, now);
  if (offset_ == scan.size()) EndCursorScan();
  return true;
}

void TraverseStream::EndCursorScan() {
  ++next_;
  offset_ = 0;
  header_sent_ = false;
}

void TraverseStream::OnWriteDone(bool ok) {
  {
    const std::lock_guard lock(queue_.mutex);
    writing_ = false;
    if (queue_.IsDone()) queue_.changed.notify_all();
  }
  if (ok) SendNext();
}

void TraverseStream::OnDone(const grpc::Status& status) {
  const std::lock_guard lock(queue_.mutex);
  ended_ = status;
  queue_.changed.notify_all();
}

}  // namespace curvereg::internal
