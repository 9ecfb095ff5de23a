// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/download_stream.h"

#include <algorithm>

#include "client/retry.h"
#include "curvereg/v1/scan_service.grpc.pb.h"
#include "wire/digest.h"
#include "wire/error.h"
#include "wire/point_codec.h"

namespace curvereg::internal {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPollInterval(20);  // of progress and of the server's silence
// Reserved on the server's word alone; what comes beyond grows as it comes.
constexpr uint64_t kMaxReservedBytes = uint64_t{64} << 20;

}  // namespace

absl::Status DownloadStream::Run(Connection& connection, const std::shared_ptr<grpc::Channel>& channel,
                                 std::chrono::milliseconds silence, const std::stop_token& cancellation,
                                 const std::function<void(uint64_t)>& on_progress) {
  connection.Prepare(context_);
  const auto stub = v1::ScanService::NewStub(channel);
  stub->async()->DownloadScan(&context_, &request_, this);
  StartRead(&response_);
  StartCall();
  bool silent = false;
  {
    const std::stop_callback cancel(cancellation, [this] { context_.TryCancel(); });
    silent = Await(silence, on_progress);
  }
  if (!broken_.ok()) return broken_;
  if (cancellation.stop_requested()) return absl::CancelledError("cancelled by the caller");
  if (silent) return absl::UnavailableError("the server has fallen silent");
  if (!ended_->ok()) return CallError(*ended_, context_);
  const bool complete = state_.scan && state_.payload.size() == state_.scan->payload_bytes();
  return complete ? absl::OkStatus() : absl::UnavailableError("the server ended the download early");
}

bool DownloadStream::Await(std::chrono::milliseconds silence, const std::function<void(uint64_t)>& on_progress) {
  std::unique_lock lock(mutex_);
  uint64_t told = request_.offset();
  bool silent = false;
  do {  // at least once: a short stream may have ended by now, and its progress counts
    changed_.wait_for(lock, kPollInterval, [&] { return ended_.has_value(); });
    if (state_.payload.size() != told) {
      told = state_.payload.size();
      lock.unlock();
      on_progress(told);
      lock.lock();
    }
    if (ended_ || silent || Clock::now() - last_answer_ <= silence) continue;
    silent = true;
    context_.TryCancel();
  } while (!ended_ || state_.payload.size() != told);
  return silent;
}

void DownloadStream::OnReadDone(bool ok) {
  if (!ok) return;
  bool go_on = false;
  {
    const std::lock_guard lock(mutex_);
    last_answer_ = Clock::now();
    broken_ = Take(response_);
    go_on = broken_.ok();
  }
  if (go_on) {
    StartRead(&response_);
  } else {
    context_.TryCancel();
  }
}

absl::Status DownloadStream::Take(const v1::DownloadScanResponse& response) {
  if (response.has_scan() && !has_scan_) return TakeScan(response.scan());
  if (response.has_chunk() && has_scan_) return TakeChunk(response.chunk());
  return absl::InternalError("the server's answers to a download come in the wrong order");
}

absl::Status DownloadStream::TakeScan(const v1::Scan& scan) {
  has_scan_ = true;
  if (state_.scan) {
    const bool same = state_.scan->payload_bytes() == scan.payload_bytes() &&
                      wire::SameDigest(state_.scan->payload_digest(), scan.payload_digest());
    return same ? absl::OkStatus() : absl::AbortedError("the scan changed while it was downloaded");
  }
  const absl::Status usable = wire::ValidateHeader(scan.header(), scan.payload_bytes(), {});
  if (!usable.ok()) return usable;
  state_.scan = scan;
  state_.payload.reserve(std::min(scan.payload_bytes(), kMaxReservedBytes));
  return absl::OkStatus();
}

absl::Status DownloadStream::TakeChunk(const v1::PayloadChunk& chunk) {
  const uint64_t left = state_.scan->payload_bytes() - state_.payload.size();
  if (chunk.offset() != state_.payload.size() || chunk.data().size() > left) {
    return absl::InternalError("a chunk of a download lies in the wrong place");
  }
  if (!chunk.has_crc32c() || wire::Crc32c(chunk.data()) != chunk.crc32c()) {
    return wire::MakeError(v1::ERROR_REASON_CHECKSUM_MISMATCH, "a chunk of a download came damaged");
  }
  state_.payload += chunk.data();
  return absl::OkStatus();
}

void DownloadStream::OnDone(const grpc::Status& status) {
  const std::lock_guard lock(mutex_);
  ended_ = status;
  changed_.notify_one();
}

}  // namespace curvereg::internal
