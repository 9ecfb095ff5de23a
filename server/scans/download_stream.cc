// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/scans/download_stream.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "curvereg/v1/scan_service.grpc.pb.h"
#include "server/scans/scan_conversion.h"
#include "wire/error.h"
#include "wire/resource_names.h"

namespace curvereg::server {
namespace {

constexpr uint64_t kLeastChunkBytes = 1024;  // each chunk costs a look into the store
constexpr uint64_t kSkippedPieceBytes = uint64_t{1} << 20;
constexpr uint64_t kSkippedAtOnceBytes = uint64_t{8} << 20;  // then others have their turn

}  // namespace

const MethodTraits DownloadStream::kTraits = {v1::ScanService::service_full_name(), "DownloadScan", Scope::kRead};

DownloadStream::DownloadStream(const Environment& environment, grpc::CallbackServerContext& context,
                               const v1::DownloadScanRequest& request)
    : ResponseStream(environment.calls, kTraits, context), environment_(environment), request_(request) {
  Begin();
}

absl::StatusOr<DownloadStream::Next> DownloadStream::Make(std::deque<v1::DownloadScanResponse>& made) {
  absl::Status status;
  if (!scan_.has_value()) {
    status = OpenScan(made.emplace_back());
  } else if (offset_ < request_.offset()) {
    status = SkipPiece();
  } else {
    status = ReadChunk(made.emplace_back());
  }
  if (!status.ok()) return status;
  if (offset_ < scan_->payload_bytes) return Next::kMore;
  status = CheckDigest();
  if (!status.ok()) return status;
  return Next::kEnd;
}

absl::Status DownloadStream::OpenScan(v1::DownloadScanResponse& response) {
  const absl::StatusOr<std::string> id = wire::ScanIdOf(request_.name(), "name");
  if (!id.ok()) return id.status();
  absl::StatusOr<StoredScan> scan = environment_.store->GetScan(*id);
  if (!scan.ok()) return scan.status();
  if (request_.offset() > scan->payload_bytes) {
    return wire::MakeError(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE, "the offset lies beyond the end of the payload",
                           {{"committed_offset", absl::StrCat(scan->payload_bytes)}});
  }
  absl::StatusOr<wire::Digester> digester = wire::Digester::Create(scan->payload_digest.algorithm());
  if (!digester.ok()) return digester.status();
  digester_ = *std::move(digester);
  *response.mutable_scan() = ToWire(*scan);
  scan_ = *std::move(scan);
  return absl::OkStatus();
}

absl::Status DownloadStream::SkipPiece() {
  const uint64_t end = std::min(offset_ + kSkippedAtOnceBytes, request_.offset());
  while (offset_ < end) {
    const uint64_t size = std::min(kSkippedPieceBytes, end - offset_);
    const absl::StatusOr<std::string> data = environment_.store->ReadPayload(scan_->id, offset_, size);
    if (!data.ok()) return data.status();
    digester_->Update(*data);
    offset_ += data->size();
  }
  return absl::OkStatus();
}

absl::Status DownloadStream::ReadChunk(v1::DownloadScanResponse& response) {
  const uint64_t max_bytes = environment_.limits.max_chunk_bytes;
  const uint64_t wanted =
      request_.chunk_bytes() == 0 ? max_bytes : std::max<uint64_t>(request_.chunk_bytes(), kLeastChunkBytes);
  const uint64_t size = std::min(wanted, max_bytes);
  absl::StatusOr<std::string> data = environment_.store->ReadPayload(scan_->id, offset_, size);
  if (!data.ok()) return data.status();
  v1::PayloadChunk& chunk = *response.mutable_chunk();
  chunk.set_offset(offset_);
  chunk.set_crc32c(wire::Crc32c(*data));
  offset_ += data->size();
  digester_->Update(*data);
  chunk.set_data(*std::move(data));
  return absl::OkStatus();
}

absl::Status DownloadStream::CheckDigest() {
  if (wire::SameDigest(digester_->Digest(), scan_->payload_digest)) return absl::OkStatus();
  const absl::Status checked = environment_.store->CheckScan(scan_->id);
  if (!checked.ok()) return checked;
  // Uploaded anew meanwhile, for example.
  return wire::MakeError(v1::ERROR_REASON_STORAGE_FAULT, "the stored payload changed while it was read");
}

}  // namespace curvereg::server
