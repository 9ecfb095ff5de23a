// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/scans/download_stream.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "curvereg/v1/scan_service.grpc.pb.h"
#include "server/scans/disk_task.h"
#include "server/scans/scan_conversion.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

constexpr MethodTraits kTraits = {v1::ScanService::service_full_name(), "DownloadScan", Scope::kRead};
constexpr uint64_t kLeastChunkBytes = 1024;  // each chunk costs a look into the store

absl::Status Interruption() { return absl::CancelledError("the caller cancelled or is gone"); }

}  // namespace

DownloadStream::DownloadStream(const Environment& environment, grpc::CallbackServerContext& context,
                               const v1::DownloadScanRequest& request)
    : environment_(environment), request_(request), call_(environment.calls, kTraits, context) {
  call_.CountReceived();
  std::unique_lock lock(mutex_);
  if (!call_.admitted().ok()) End(call_.admitted());
  Advance(std::move(lock));
}

void DownloadStream::OnWriteDone(bool ok) {
  std::unique_lock lock(mutex_);
  writing_ = false;
  if (!ok) End(Interruption());
  Advance(std::move(lock));
}

void DownloadStream::OnCancel() {
  {
    const std::lock_guard lock(mutex_);
    End(Interruption());
  }
  // Drops a task that waits, on this thread, which comes back by OnWorked.
  call_.Cancel();
  Advance(std::unique_lock(mutex_));
}

absl::Status DownloadStream::Work() { return scan_.has_value() ? ReadChunk() : OpenScan(); }

absl::Status DownloadStream::OpenScan() {
  const absl::StatusOr<std::string> id = ScanIdOf(request_.name(), "name");
  if (!id.ok()) return id.status();
  absl::StatusOr<StoredScan> scan = environment_.store->GetScan(*id);
  if (!scan.ok()) return scan.status();
  if (request_.offset() > scan->payload_bytes) {
    return wire::MakeError(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE, "the offset lies beyond the end of the payload",
                           {{"committed_offset", absl::StrCat(scan->payload_bytes)}});
  }
  offset_ = request_.offset();
  if (offset_ == 0) {
    absl::StatusOr<wire::Digester> digester = wire::Digester::Create(scan->payload_digest.algorithm());
    if (!digester.ok()) return digester.status();
    digester_ = *std::move(digester);
  }
  *next_.mutable_scan() = ToWire(*scan);
  scan_ = *std::move(scan);
  return absl::OkStatus();
}

absl::Status DownloadStream::ReadChunk() {
  const uint64_t max_bytes = environment_.limits.max_chunk_bytes;
  const uint64_t wanted =
      request_.chunk_bytes() == 0 ? max_bytes : std::max<uint64_t>(request_.chunk_bytes(), kLeastChunkBytes);
  const uint64_t size = std::min(wanted, max_bytes);
  absl::StatusOr<std::string> data = environment_.store->ReadPayload(scan_->id, offset_, size);
  if (!data.ok()) return data.status();
  v1::PayloadChunk& chunk = *next_.mutable_chunk();
  chunk.set_offset(offset_);
  chunk.set_crc32c(wire::Crc32c(*data));
  offset_ += data->size();
  if (digester_.has_value()) digester_->Update(*data);
  const bool is_damaged = data->empty() || (offset_ == scan_->payload_bytes && digester_.has_value() &&
                                            !wire::SameDigest(digester_->Digest(), scan_->payload_digest));
  if (is_damaged) {
    return wire::MakeError(v1::ERROR_REASON_STORED_SCAN_DAMAGED, "the stored payload does not have its digest");
  }
  chunk.set_data(*std::move(data));
  return absl::OkStatus();
}

void DownloadStream::OnWorked(const absl::Status& status) {
  std::unique_lock lock(mutex_);
  working_ = false;
  ready_ = status.ok();
  if (!status.ok()) End(status);
  Advance(std::move(lock));
}

void DownloadStream::End(const absl::Status& status) {
  if (!end_.has_value()) end_ = status;
}

void DownloadStream::Advance(std::unique_lock<std::mutex> lock) {
  if (!end_.has_value() && ready_ && !writing_) {
    ready_ = false;
    writing_ = true;
    written_.Swap(&next_);
    call_.CountSent();
    StartWrite(&written_);
  }
  if (!working_ && !ready_ && scan_.has_value() && offset_ == scan_->payload_bytes && !writing_) End(absl::OkStatus());
  if (end_.has_value()) {
    // What is still out comes back here.
    if (working_ || writing_ || finished_) return;
    finished_ = true;
    const grpc::Status status = call_.Finish(*end_);
    lock.unlock();
    Finish(status);
    return;
  }
  const bool work = !working_ && !ready_ && !(scan_.has_value() && offset_ == scan_->payload_bytes);
  working_ = working_ || work;
  lock.unlock();
  // Without the lock, for the task may be refused or dropped at once. Until OnWorked nobody finishes the call.
  if (work) {
    RunOnDiskPool(*environment_.disk_pool, call_,
                  {[this] { return Work(); }, [this](const absl::Status& status) { OnWorked(status); }});
  }
}

}  // namespace curvereg::server
