// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/store/upload_writer.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/store/scan_identity.h"
#include "wire/digest.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

// Bytes go on their way to the disk in pieces of this size while more come in: at the end of a large upload less is
// left to wait for, and with smaller pieces Append itself would wait.
constexpr uint64_t kWritebackBytes = uint64_t{4} << 20;
// Space for a large upload is taken ahead in pieces between these, each as long as what is there: writing into it costs
// half the time, and a sender that stops leaves no more unused than it sent.
constexpr uint64_t kLeastAheadBytes = uint64_t{1} << 20;
constexpr uint64_t kMostAheadBytes = uint64_t{64} << 20;
constexpr uint64_t kReadBytes = uint64_t{1} << 20;

class UploadWriterImpl final : public UploadWriter {
 public:
  UploadWriterImpl(UploadTable::Grant grant, UploadTable& uploads, ScanChanges& scans)
      : uploads_(uploads),
        scans_(scans),
        upload_(*grant.upload),
        grant_(std::move(grant)),
        committed_offset_(grant_.committed_offset),
        writeback_offset_(committed_offset_) {}

  uint64_t committed_offset() const override { return committed_offset_; }

  absl::Status Append(uint64_t offset, std::span<const std::string_view> pieces) override {
    uint64_t size = 0;
    for (const std::string_view piece : pieces) size += piece.size();
    const std::lock_guard lock(upload_.mutex);
    if (absl::Status status = CheckGrant(); !status.ok()) return status;
    if (offset != upload_.committed_offset) return OutOfRange("the bytes do not begin at the committed offset");
    if (size > upload_.description.payload_bytes - offset) return OutOfRange("more bytes than were declared");
    // First, for then the processor's cache has what is to be written.
    if (upload_.digested_bytes == offset) {
      for (const std::string_view piece : pieces) Digest(piece);
    }
    TakeSpace(offset + size);
    if (absl::Status status = grant_.file.WriteAt(offset, pieces); !status.ok()) {
      // What stays behind when even this fails is right as far as it goes.
      static_cast<void>(grant_.file.Truncate(offset));
      upload_.digester.reset();
      upload_.digested_bytes = 0;
      return status;
    }
    uploads_.AddProgress(upload_, size);
    committed_offset_ = upload_.committed_offset;
    if (committed_offset_ - writeback_offset_ >= kWritebackBytes) {
      grant_.file.StartWriteback(writeback_offset_, committed_offset_ - writeback_offset_);
      writeback_offset_ = committed_offset_;
    }
    return absl::OkStatus();
  }

  absl::StatusOr<std::string> ReadAll() override {
    const std::lock_guard lock(upload_.mutex);
    if (absl::Status status = CheckGrant(); !status.ok()) return status;
    return Read(0, upload_.committed_offset);
  }

  absl::StatusOr<v1::Digest> PayloadDigest() override {
    const std::lock_guard lock(upload_.mutex);
    if (absl::Status status = CheckGrant(); !status.ok()) return status;
    return CurrentDigest();
  }

  absl::StatusOr<Committed> Commit(uint64_t finite_point_count, const std::string& content_digest) override {
    const std::lock_guard lock(upload_.mutex);
    if (absl::Status status = CheckGrant(); !status.ok()) return status;
    const UploadDescription& description = upload_.description;
    if (upload_.committed_offset != description.payload_bytes) return OutOfRange("the upload is not complete");
    absl::StatusOr<v1::Digest> digest = CurrentDigest();
    if (!digest.ok()) return digest.status();
    StoredScan scan;
    scan.id = ScanId(description.header, *digest);
    scan.header = description.header;
    scan.payload_bytes = description.payload_bytes;
    scan.payload_digest = *std::move(digest);
    scan.finite_point_count = finite_point_count;
    scan.content_digest = content_digest;
    scan.create_time = std::chrono::system_clock::now();
    return scans_.CommitUpload(upload_, grant_.file, std::move(scan));
  }

  absl::Status Discard() override {
    const std::lock_guard lock(upload_.mutex);
    if (absl::Status status = CheckGrant(); !status.ok()) return status;
    uploads_.Drop(upload_);
    return absl::OkStatus();
  }

 private:
  absl::Status CheckGrant() const {
    if (!upload_.has_ended && upload_.writer_epoch == grant_.epoch) return absl::OkStatus();
    return wire::MakeError(v1::ERROR_REASON_WRITER_REPLACED,
                           upload_.has_ended ? "the upload has ended" : "another stream took the upload over");
  }

  absl::Status OutOfRange(std::string_view message) const {
    return wire::MakeError(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE, message,
                           {{"committed_offset", absl::StrCat(upload_.committed_offset)}});
  }

  // For the bytes before `end` and some after it.
  void TakeSpace(uint64_t end) {
    if (end <= std::max(space_end_, kLeastAheadBytes)) return;
    const uint64_t begin = std::max(space_end_, upload_.committed_offset);
    const uint64_t ahead = std::clamp(end, kLeastAheadBytes, kMostAheadBytes);
    space_end_ = std::min(end + ahead, upload_.description.payload_bytes);
    grant_.file.Preallocate(begin, space_end_ - begin);
  }

  absl::StatusOr<std::string> Read(uint64_t offset, uint64_t size) const {
    absl::StatusOr<std::string> bytes = grant_.file.ReadAt(offset, size);
    if (bytes.ok() && bytes->size() != size) {
      return wire::MakeError(v1::ERROR_REASON_STORAGE_FAULT, "the upload's file is shorter than what was written");
    }
    return bytes;
  }

  void Digest(std::string_view bytes) {
    if (upload_.digester == nullptr) {
      // Known algorithm: cannot fail.
      upload_.digester =
          std::make_unique<wire::Digester>(wire::Digester::Create(v1::DIGEST_ALGORITHM_XXH3_128).value());
    }
    upload_.digester->Update(bytes);
    upload_.digested_bytes += bytes.size();
  }

  absl::StatusOr<v1::Digest> CurrentDigest() {
    if (upload_.digester == nullptr) Digest({});
    while (upload_.digested_bytes < upload_.committed_offset) {
      const uint64_t size = std::min(kReadBytes, upload_.committed_offset - upload_.digested_bytes);
      const absl::StatusOr<std::string> piece = Read(upload_.digested_bytes, size);
      if (!piece.ok()) return piece.status();
      Digest(*piece);
    }
    return upload_.digester->Digest();
  }

  UploadTable& uploads_;
  ScanChanges& scans_;
  Upload& upload_;  // grant_'s
  UploadTable::Grant grant_;
  uint64_t committed_offset_;
  uint64_t writeback_offset_;
  uint64_t space_end_ = 0;  // space is taken up to here
};

}  // namespace

std::unique_ptr<UploadWriter> MakeUploadWriter(UploadTable::Grant grant, UploadTable& uploads, ScanChanges& scans) {
  return std::make_unique<UploadWriterImpl>(std::move(grant), uploads, scans);
}

}  // namespace curvereg::server
