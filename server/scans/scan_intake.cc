// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/scans/scan_intake.h"

#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "wire/digest.h"
#include "wire/error.h"
#include "wire/point_codec.h"
#include "wire/point_layout.h"

namespace curvereg::server {
namespace {

// What is counted, hashed and written in one go, so that the processor's own cache still has it.
constexpr uint64_t kBlockBytes = 256 * 1024;

// For the payload as stored and all that decoding takes.
uint64_t FinishingBytes(const UploadDescription& description) {
  return wire::DecodingBytes(description.header) + description.payload_bytes;
}

// Points as the core has them: three packed floats each.
bool IsPlain(const v1::PointCloudHeader& header) {
  return header.encoding() == v1::POINT_ENCODING_RAW && wire::IsPackedFloats(header.layout());
}

}  // namespace

absl::StatusOr<std::optional<StoredScan>> ScanIntake::Begin(UploadDescription description) {
  description_ = std::move(description);
  // An error now saves the transfer.
  const uint64_t needed = FinishingBytes(description_);
  if (needed > environment_.memory->total_bytes()) {
    return wire::MakeError(
        v1::ERROR_REASON_SCAN_TOO_LARGE, "decoding needs more memory than the server may ever use",
        {{"limit", absl::StrCat(environment_.memory->total_bytes())}, {"value", absl::StrCat(needed)}});
  }
  absl::StatusOr<std::optional<StoredScan>> known = FindKnown();
  if (!known.ok()) return known.status();
  is_stored_ = known->has_value();
  if (is_stored_) return known;
  const absl::Status begun =
      environment_.owners->TakeOver(description_.id, replaced_, [this] { return BeginWriting(); });
  if (!begun.ok()) return begun;
  if (writer_->committed_offset() > 0) environment_.metrics->UploadResumed();
  if (IsPlain(description_.header) && writer_->committed_offset() == 0) finite_points_.emplace();
  return std::nullopt;
}

void ScanIntake::BeginStored(UploadDescription description) {
  description_ = std::move(description);
  is_stored_ = true;
}

// The store knows payloads by XXH3_128 alone; with another digest the transfer decides.
absl::StatusOr<std::optional<StoredScan>> ScanIntake::FindKnown() const {
  const std::optional<v1::Digest>& digest = description_.payload_digest;
  if (!digest.has_value() || digest->algorithm() != v1::DIGEST_ALGORITHM_XXH3_128) return std::nullopt;
  absl::StatusOr<std::optional<StoredScan>> known = environment_.store->FindScan(description_);
  if (!known.ok() || !known->has_value()) return known;
  // The unfinished upload of an earlier stream is not needed any more. If this fails, it expires.
  if (environment_.store->GetUpload(description_.id).ok()) {
    const absl::StatusOr<std::unique_ptr<UploadWriter>> rest = environment_.store->BeginUpload(description_);
    if (rest.ok()) (*rest)->Discard().IgnoreError();
  }
  return known;
}

absl::Status ScanIntake::BeginWriting() {
  absl::StatusOr<std::unique_ptr<UploadWriter>> writer = environment_.store->BeginUpload(description_);
  if (writer.ok()) writer_ = *std::move(writer);
  return writer.status();
}

uint64_t ScanIntake::committed_offset() const {
  if (is_stored_) return description_.payload_bytes;
  return writer_ == nullptr ? 0 : writer_->committed_offset();
}

absl::Status ScanIntake::Append(const ReceivedChunk& chunk, Overlap overlap) {
  uint64_t size = 0;
  for (const std::string_view piece : chunk.pieces) size += piece.size();
  if (absl::Status valid = CheckChunk(chunk, overlap, size); !valid.ok()) return valid;
  const uint64_t num_known = committed_offset() - chunk.offset;
  return num_known < size ? Store(chunk.pieces, num_known) : absl::OkStatus();
}

absl::Status ScanIntake::CheckChunk(const ReceivedChunk& chunk, Overlap overlap, uint64_t size) const {
  const uint32_t max_bytes = environment_.limits.max_chunk_bytes;
  if (size == 0 || size > max_bytes) {
    return wire::FieldError("chunk.data", absl::StrCat("must have 1 to ", max_bytes, " bytes"));
  }
  if (!chunk.declared_crc32c.has_value()) return wire::FieldError("chunk.crc32c", "is required");
  if (overlap == Overlap::kRefuse && chunk.offset != committed_offset()) {
    return OffsetError("a chunk does not begin at the committed offset");
  }
  if (chunk.offset > committed_offset()) return OffsetError("a chunk begins beyond the committed offset");
  if (size > description_.payload_bytes - chunk.offset) {
    return OffsetError("a chunk goes beyond the declared size");
  }
  if (chunk.crc32c != *chunk.declared_crc32c) {
    environment_.metrics->ChecksumFailed();
    return wire::MakeError(v1::ERROR_REASON_CHECKSUM_MISMATCH, "a chunk does not have the CRC-32C that came with it");
  }
  return absl::OkStatus();
}

absl::Status ScanIntake::Store(std::span<const std::string_view> pieces, uint64_t num_skipped) {
  std::vector<std::string_view> block;
  uint64_t size = 0;
  for (std::string_view piece : pieces) {
    const uint64_t num_front = std::min<uint64_t>(num_skipped, piece.size());
    piece.remove_prefix(num_front);
    num_skipped -= num_front;
    while (!piece.empty()) {
      block.push_back(piece.substr(0, kBlockBytes - size));
      size += block.back().size();
      piece.remove_prefix(block.back().size());
      if (size < kBlockBytes) continue;
      if (absl::Status stored = StoreBlock(block); !stored.ok()) return stored;
      block.clear();
      size = 0;
    }
  }
  return StoreBlock(block);
}

absl::Status ScanIntake::StoreBlock(std::span<const std::string_view> pieces) {
  if (finite_points_.has_value()) {
    for (const std::string_view piece : pieces) finite_points_->Update(piece);
  }
  return writer_->Append(writer_->committed_offset(), pieces);
}

absl::Status ScanIntake::OffsetError(std::string_view message) const {
  return wire::MakeError(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE, message,
                         {{"committed_offset", absl::StrCat(committed_offset())}});
}

absl::StatusOr<UploadWriter::Committed> ScanIntake::Finish(const v1::Digest& declared) {
  if (!is_complete()) return OffsetError("finish came before all bytes");
  absl::StatusOr<UploadWriter::Committed> committed = CheckAndCommit(declared);
  if (committed.ok()) {
    is_stored_ = true;
    Close();
    return committed;
  }
  const std::optional<v1::ErrorReason> reason = wire::ReasonOf(committed.status());
  if (reason == v1::ERROR_REASON_DIGEST_MISMATCH || reason == v1::ERROR_REASON_MALFORMED_PAYLOAD) {
    // If this fails, the upload expires. The caller gets the error of the payload.
    writer_->Discard().IgnoreError();
  }
  return committed;
}

absl::StatusOr<UploadWriter::Committed> ScanIntake::CheckAndCommit(const v1::Digest& declared) {
  // The store's own digest costs no memory, so it goes first.
  if (declared.algorithm() == v1::DIGEST_ALGORITHM_XXH3_128) {
    const absl::StatusOr<v1::Digest> actual = writer_->PayloadDigest();
    if (!actual.ok()) return actual.status();
    if (absl::Status same = CheckDigest(declared, *actual); !same.ok()) return same;
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
    absl::Status same = CheckDigest(declared, wire::DigestOf(declared.algorithm(), *payload));
    if (!same.ok()) return same;
  }
  const LimitsConfig& limits = environment_.limits;
  const absl::StatusOr<Scan> scan =
      wire::DecodeScan(description_.header, *payload, {limits.max_scan_points, limits.max_scan_bytes});
  if (!scan.ok()) return scan.status();
  return Commit(static_cast<uint64_t>(CountFinitePoints(*scan)), ScanDigest(*scan));
}

absl::StatusOr<UploadWriter::Committed> ScanIntake::Commit(uint64_t finite_point_count,
                                                           const std::string& content_digest) {
  absl::StatusOr<UploadWriter::Committed> committed = writer_->Commit(finite_point_count, content_digest);
  if (!committed.ok()) return committed;
  environment_.metrics->UploadCompleted(description_.payload_bytes);
  environment_.metrics->ScanReceived(description_.header.point_count());
  return committed;
}

absl::Status ScanIntake::CheckDigest(const v1::Digest& declared, const v1::Digest& actual) const {
  if (wire::SameDigest(declared, actual)) return absl::OkStatus();
  environment_.metrics->ChecksumFailed();
  return wire::MakeError(v1::ERROR_REASON_DIGEST_MISMATCH, "the payload does not have the digest that was declared");
}

void ScanIntake::Close() {
  if (writer_ == nullptr) return;
  environment_.owners->Release(description_.id, replaced_);
  writer_.reset();
}

}  // namespace curvereg::server
