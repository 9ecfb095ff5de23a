// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A store without a disk, for one stream at a time: so that fuzzing an upload costs microseconds.
#ifndef CURVEREG_FUZZ_MEMORY_SCAN_STORE_H_
#define CURVEREG_FUZZ_MEMORY_SCAN_STORE_H_

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/store/page_token.h"
#include "server/store/scan_store.h"
#include "wire/digest.h"
#include "wire/error.h"

namespace curvereg::server {

class MemoryUpload final : public UploadWriter {
 public:
  MemoryUpload(UploadDescription description, std::string& bytes)
      : description_(std::move(description)), bytes_(bytes) {}
  uint64_t committed_offset() const override { return bytes_.size(); }
  absl::Status Append(uint64_t offset, std::span<const std::string_view> pieces) override {
    if (offset != bytes_.size()) return wire::MakeError(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE, "not the offset");
    for (const std::string_view piece : pieces) bytes_.append(piece);
    return absl::OkStatus();
  }
  absl::StatusOr<std::string> ReadAll() override { return bytes_; }
  absl::StatusOr<v1::Digest> PayloadDigest() override { return wire::DigestOf(v1::DIGEST_ALGORITHM_XXH3_128, bytes_); }
  absl::StatusOr<Committed> Commit(uint64_t finite_point_count, const std::string& content_digest) override {
    Committed committed;
    committed.scan.id = std::string(32, '0');
    committed.scan.header = description_.header;
    committed.scan.payload_bytes = bytes_.size();
    committed.scan.finite_point_count = finite_point_count;
    committed.scan.content_digest = content_digest;
    return committed;
  }
  absl::Status Discard() override {
    bytes_.clear();
    return absl::OkStatus();
  }

 private:
  const UploadDescription description_;
  std::string& bytes_;
};

class MemoryScanStore final : public ScanStore {
 public:
  absl::StatusOr<std::unique_ptr<UploadWriter>> BeginUpload(const UploadDescription& description) override {
    return std::make_unique<MemoryUpload>(description, bytes_);
  }
  absl::StatusOr<UploadState> GetUpload(const std::string&) override {
    return wire::MakeError(v1::ERROR_REASON_UPLOAD_NOT_FOUND, "none");
  }
  absl::StatusOr<int> ExpireUploads(std::chrono::system_clock::time_point) override { return 0; }
  absl::StatusOr<std::optional<StoredScan>> FindScan(const UploadDescription&) override { return std::nullopt; }
  absl::StatusOr<StoredScan> GetScan(const std::string&) override { return NoScan(); }
  absl::StatusOr<std::string> ReadPayload(const std::string&, uint64_t, uint64_t) override { return NoScan(); }
  absl::StatusOr<std::string> ReadWholePayload(const std::string&) override { return NoScan(); }
  absl::Status CheckScan(const std::string&) override { return NoScan(); }
  absl::StatusOr<ScanPage> ListScans(int, const std::string& page_token) override {
    if (!page_token.empty() && !PlaceOfToken(page_token).has_value()) return wire::FieldError("page_token", "not ours");
    return ScanPage();
  }
  absl::Status DeleteScan(const std::string&) override { return NoScan(); }
  absl::Status WithReservedSpace(const std::function<absl::Status()>& work) override { return work(); }
  StoreStatistics Statistics() override { return {}; }
  std::vector<std::string> DamagedScans() override { return {}; }
  RecoveryReport Recovery() override { return {}; }

 private:
  static absl::Status NoScan() { return wire::MakeError(v1::ERROR_REASON_SCAN_NOT_FOUND, "none"); }

  std::string bytes_;  // of the upload
};

}  // namespace curvereg::server

#endif  // CURVEREG_FUZZ_MEMORY_SCAN_STORE_H_
