// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/scans/upload_session.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/scan/scan.h"
#include "server/scans/scan_conversion.h"
#include "wire/digest.h"
#include "wire/error.h"
#include "wire/point_codec.h"
#include "wire/point_layout.h"
#include "wire/resource_names.h"

namespace curvereg::server {
namespace {

// What is counted, hashed and written in one go, so that the processor's own cache still has it.
constexpr uint64_t kBlockBytes = 256 * 1024;

absl::Status OrderError(std::string_view message) {
  return wire::MakeError(v1::ERROR_REASON_UNEXPECTED_MESSAGE, message);
}

wire::PointLimits DecodingLimits(const LimitsConfig& limits) { return {limits.max_scan_points, limits.max_scan_bytes}; }

// For the payload as stored and all that decoding takes.
uint64_t FinishingBytes(const UploadDescription& description) {
  return wire::DecodingBytes(description.header) + description.payload_bytes;
}

absl::StatusOr<UploadDescription> Describe(v1::UploadScanStart& start, const LimitsConfig& limits) {
  UploadDescription description;
  absl::StatusOr<std::string> id = wire::UploadIdOf(start.upload(), "start.upload");
  if (!id.ok()) return id.status();
  description.id = *std::move(id);
  if (!start.has_header()) return wire::FieldError("start.header", "is missing");
  if (start.payload_bytes() == 0) return wire::FieldError("start.payload_bytes", "must be above 0");
  absl::Status valid = wire::ValidateHeader(start.header(), start.payload_bytes(), DecodingLimits(limits));
  if (!valid.ok()) return wire::WithinField("start.header", std::move(valid));
  description.header = std::move(*start.mutable_header());
  description.payload_bytes = start.payload_bytes();
  if (start.has_payload_digest()) {
    valid = wire::ValidateDigest(start.payload_digest());
    if (!valid.ok()) return wire::WithinField("start.payload_digest", std::move(valid));
    description.payload_digest = std::move(*start.mutable_payload_digest());
  }
  return description;
}

// The digest that the payload must have: told by `start`, by `finish`, or alike by both.
absl::StatusOr<v1::Digest> DeclaredDigest(const std::optional<v1::Digest>& at_start,
                                          const v1::UploadScanFinish& finish) {
  if (!finish.has_payload_digest()) {
    if (at_start.has_value()) return *at_start;
    return wire::FieldError("finish.payload_digest", "is required unless start had one");
  }
  absl::Status valid = wire::ValidateDigest(finish.payload_digest());
  if (!valid.ok()) return wire::WithinField("finish.payload_digest", std::move(valid));
  if (at_start.has_value() && !wire::SameDigest(*at_start, finish.payload_digest())) {
    return wire::FieldError("finish.payload_digest", "differs from the one of start");
  }
  return finish.payload_digest();
}

v1::UploadScanResponse Done(const StoredScan& scan, bool already_stored) {
  v1::UploadScanResponse response;
  *response.mutable_done()->mutable_scan() = ToWire(scan);
  response.mutable_done()->set_already_stored(already_stored);
  return response;
}

}  // namespace

absl::Status UploadOwners::TakeOver(const std::string& upload_id, const std::stop_source& owner,
                                    const std::function<absl::Status()>& begin) {
  std::stop_source former(std::nostopstate);
  {
    const std::lock_guard beginning(begin_mutexes_[std::hash<std::string>()(upload_id) % begin_mutexes_.size()]);
    if (const absl::Status begun = begin(); !begun.ok()) return begun;
    const std::lock_guard lock(mutex_);
    // A new entry is without a state to stop.
    former = std::exchange(owners_.try_emplace(upload_id, std::nostopstate).first->second, owner);
  }
  // Runs the other stream's reaction, so without a lock of ours.
  former.request_stop();
  return absl::OkStatus();
}

void UploadOwners::Release(const std::string& upload_id, const std::stop_source& owner) {
  const std::lock_guard lock(mutex_);
  const auto found = owners_.find(upload_id);
  if (found != owners_.end() && found->second == owner) owners_.erase(found);
}

UploadSession::~UploadSession() {
  if (writer_ != nullptr) environment_.owners->Release(description_.id, replaced_);
}

absl::StatusOr<v1::UploadScanResponse> UploadSession::Handle(UploadMessage& message) {
  v1::UploadScanRequest& request = message.request();
  if (request.has_start() == (writer_ != nullptr)) {
    return OrderError(writer_ == nullptr ? "the first message must be start" : "start came a second time");
  }
  switch (request.message_case()) {
    case v1::UploadScanRequest::kStart:
      return Start(*request.mutable_start());
    case v1::UploadScanRequest::kChunk:
      return Append(message);
    case v1::UploadScanRequest::kFinish:
      return Finish(request.finish());
    default:
      return OrderError("a message was empty, or of a kind that this server does not know");
  }
}

absl::StatusOr<v1::UploadScanResponse> UploadSession::Start(v1::UploadScanStart& start) {
  absl::StatusOr<UploadDescription> description = Describe(start, environment_.limits);
  if (!description.ok()) return description.status();
  description_ = *std::move(description);
  // Better said now than after the transfer.
  const uint64_t needed = FinishingBytes(description_);
  if (needed > environment_.memory->total_bytes()) {
    return wire::MakeError(
        v1::ERROR_REASON_SCAN_TOO_LARGE, "decoding needs more memory than the server may ever use",
        {{"limit", absl::StrCat(environment_.memory->total_bytes())}, {"value", absl::StrCat(needed)}});
  }
  const absl::StatusOr<std::optional<StoredScan>> known = FindKnown();
  if (!known.ok()) return known.status();
  if (known->has_value()) return Done(**known, true);
  const absl::Status begun = environment_.owners->TakeOver(description_.id, replaced_, [this] {
    absl::StatusOr<std::unique_ptr<UploadWriter>> writer = environment_.store->BeginUpload(description_);
    if (!writer.ok()) return writer.status();
    writer_ = *std::move(writer);
    return absl::OkStatus();
  });
  if (!begun.ok()) return begun;
  if (writer_->committed_offset() > 0) environment_.metrics->UploadResumed();
  const bool is_plain =
      description_.header.encoding() == v1::POINT_ENCODING_RAW && wire::IsPackedFloats(description_.header.layout());
  if (is_plain && writer_->committed_offset() == 0) finite_points_.emplace();
  v1::UploadScanResponse response;
  response.mutable_ready()->set_committed_offset(writer_->committed_offset());
  response.mutable_ready()->set_max_chunk_bytes(environment_.limits.max_chunk_bytes);
  return response;
}

// The store knows payloads by XXH3_128 alone; with another digest the transfer decides.
absl::StatusOr<std::optional<StoredScan>> UploadSession::FindKnown() const {
  const std::optional<v1::Digest>& digest = description_.payload_digest;
  if (!digest.has_value() || digest->algorithm() != v1::DIGEST_ALGORITHM_XXH3_128) return std::nullopt;
  absl::StatusOr<std::optional<StoredScan>> known = environment_.store->FindScan(description_);
  if (!known.ok() || !known->has_value()) return known;
  // What came of it in an earlier stream is of no use any more. Should this fail, it expires.
  if (environment_.store->GetUpload(description_.id).ok()) {
    const absl::StatusOr<std::unique_ptr<UploadWriter>> rest = environment_.store->BeginUpload(description_);
    if (rest.ok()) (*rest)->Discard().IgnoreError();
  }
  return known;
}

absl::StatusOr<v1::UploadScanResponse> UploadSession::Append(const UploadMessage& message) {
  const v1::PayloadChunk& chunk = message.request().chunk();
  const std::vector<std::string_view>& data = message.chunk_data();
  uint64_t size = 0;
  for (const std::string_view piece : data) size += piece.size();
  const uint32_t max_bytes = environment_.limits.max_chunk_bytes;
  if (size == 0 || size > max_bytes) {
    return wire::FieldError("chunk.data", absl::StrCat("must have 1 to ", max_bytes, " bytes"));
  }
  if (!chunk.has_crc32c()) return wire::FieldError("chunk.crc32c", "is required");
  const uint64_t committed = writer_->committed_offset();
  if (chunk.offset() != committed) return OffsetError("a chunk does not begin at the committed offset");
  if (size > description_.payload_bytes - committed) {
    return OffsetError("a chunk goes beyond the declared size");
  }
  if (message.chunk_crc32c() != chunk.crc32c()) {
    environment_.metrics->ChecksumFailed();
    return wire::MakeError(v1::ERROR_REASON_CHECKSUM_MISMATCH, "a chunk does not have the CRC-32C that came with it");
  }
  if (const absl::Status stored = Store(data); !stored.ok()) return stored;
  v1::UploadScanResponse response;
  response.mutable_progress()->set_committed_offset(writer_->committed_offset());
  return response;
}

absl::Status UploadSession::Store(std::span<const std::string_view> pieces) {
  std::vector<std::string_view> block;
  uint64_t size = 0;
  for (std::string_view piece : pieces) {
    while (!piece.empty()) {
      block.push_back(piece.substr(0, kBlockBytes - size));
      size += block.back().size();
      piece.remove_prefix(block.back().size());
      if (size < kBlockBytes) continue;
      if (const absl::Status stored = StoreBlock(block); !stored.ok()) return stored;
      block.clear();
      size = 0;
    }
  }
  return StoreBlock(block);
}

absl::Status UploadSession::StoreBlock(std::span<const std::string_view> pieces) {
  if (finite_points_.has_value()) {
    for (const std::string_view piece : pieces) finite_points_->Update(piece);
  }
  return writer_->Append(writer_->committed_offset(), pieces);
}

absl::Status UploadSession::OffsetError(std::string_view message) const {
  return wire::MakeError(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE, message,
                         {{"committed_offset", absl::StrCat(writer_->committed_offset())}});
}

absl::StatusOr<v1::UploadScanResponse> UploadSession::Finish(const v1::UploadScanFinish& finish) {
  const absl::StatusOr<v1::Digest> declared = DeclaredDigest(description_.payload_digest, finish);
  if (!declared.ok()) return declared.status();
  if (writer_->committed_offset() != description_.payload_bytes) return OffsetError("finish came before all bytes");
  absl::StatusOr<v1::UploadScanResponse> done = DecodeAndCommit(*declared);
  const std::optional<v1::ErrorReason> reason = wire::ReasonOf(done.status());
  if (reason == v1::ERROR_REASON_DIGEST_MISMATCH || reason == v1::ERROR_REASON_MALFORMED_PAYLOAD) {
    // Should this fail, it expires; the caller has the cause that matters.
    writer_->Discard().IgnoreError();
  }
  return done;
}

absl::StatusOr<v1::UploadScanResponse> UploadSession::DecodeAndCommit(const v1::Digest& declared) {
  // The store's own digest costs no memory, so it goes first.
  if (declared.algorithm() == v1::DIGEST_ALGORITHM_XXH3_128) {
    const absl::StatusOr<v1::Digest> actual = writer_->PayloadDigest();
    if (!actual.ok()) return actual.status();
    if (const absl::Status same = CheckDigest(declared, *actual); !same.ok()) return same;
    // The payload is the coordinates, byte for byte.
    const std::optional<uint64_t> points_hash = wire::Xxh3Of64Bits(*actual, description_.payload_bytes);
    if (finite_points_.has_value() && points_hash.has_value()) {
      return Commit(static_cast<uint64_t>(finite_points_->count()),
                    ScanDigestOfHash(*points_hash, wire::GravityOf(description_.header)));
    }
  }
  const absl::StatusOr<MemoryBudget::Reservation> reservation =
      environment_.memory->Reserve(FinishingBytes(description_));
  if (!reservation.ok()) return reservation.status();
  const absl::StatusOr<std::string> payload = writer_->ReadAll();
  if (!payload.ok()) return payload.status();
  if (declared.algorithm() != v1::DIGEST_ALGORITHM_XXH3_128) {
    const absl::Status same = CheckDigest(declared, wire::DigestOf(declared.algorithm(), *payload));
    if (!same.ok()) return same;
  }
  const absl::StatusOr<Scan> scan =
      wire::DecodeScan(description_.header, *payload, DecodingLimits(environment_.limits));
  if (!scan.ok()) return scan.status();
  return Commit(static_cast<uint64_t>(CountFinitePoints(*scan)), ScanDigest(*scan));
}

absl::StatusOr<v1::UploadScanResponse> UploadSession::Commit(uint64_t finite_point_count,
                                                             const std::string& content_digest) {
  const absl::StatusOr<UploadWriter::Committed> committed = writer_->Commit(finite_point_count, content_digest);
  if (!committed.ok()) return committed.status();
  environment_.metrics->UploadCompleted(description_.payload_bytes);
  environment_.metrics->ScanReceived(description_.header.point_count());
  return Done(committed->scan, committed->already_stored);
}

absl::Status UploadSession::CheckDigest(const v1::Digest& declared, const v1::Digest& actual) {
  if (wire::SameDigest(declared, actual)) return absl::OkStatus();
  environment_.metrics->ChecksumFailed();
  return wire::MakeError(v1::ERROR_REASON_DIGEST_MISMATCH, "the payload does not have the digest that was declared");
}

}  // namespace curvereg::server
