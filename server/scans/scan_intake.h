// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// One payload on its way into the store, whichever method brings it (UploadScan, StreamScans): checks of its chunks,
// writing, its digest, decoding, commit. Runs on the disk pool.
#ifndef CURVEREG_SERVER_SCANS_SCAN_INTAKE_H_
#define CURVEREG_SERVER_SCANS_SCAN_INTAKE_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "core/scan/scan.h"
#include "server/operations/metrics.h"
#include "server/scans/upload_owners.h"
#include "server/scheduling/memory_budget.h"
#include "server/settings/server_config.h"
#include "server/store/scan_store.h"

namespace curvereg::server {

// What intakes share. All outlive them.
struct UploadEnvironment {
  LimitsConfig limits;
  MemoryBudget* memory = nullptr;
  ScanStore* store = nullptr;
  Metrics* metrics = nullptr;
  UploadOwners* owners = nullptr;
};

// A chunk of a payload as it was received.
struct ReceivedChunk {
  uint64_t offset = 0;                                     // in the payload
  std::span<const std::string_view> pieces = {};           // its data, no piece empty
  std::optional<uint32_t> declared_crc32c = std::nullopt;  // by the client
  uint32_t crc32c = 0;                                     // of the data as received
};

// Used by one thread at a time.
class ScanIntake {
 public:
  // Of bytes that are committed already: a chunk with such bytes is an error, or they are checked and left out.
  enum class Overlap { kRefuse, kSkip };

  // `replaced` is requested to stop when another stream takes the upload over.
  ScanIntake(const UploadEnvironment& environment, std::stop_source replaced)
      : environment_(environment), replaced_(std::move(replaced)) {}
  ~ScanIntake() { Close(); }
  ScanIntake(const ScanIntake&) = delete;
  ScanIntake& operator=(const ScanIntake&) = delete;

  // Once, unless it fails. The scan, when the store has it already (known by its XXH3_128 digest); else nullopt: the
  // payload is expected from committed_offset() on. Precondition: header, size and digest are valid. SCAN_TOO_LARGE
  // (decoding would take more memory than the server has); errors of ScanStore::FindScan and BeginUpload.
  absl::StatusOr<std::optional<StoredScan>> Begin(UploadDescription description);
  // Instead of Begin, for a scan that the caller knows to be stored.
  void BeginStored(UploadDescription description);

  // After Begin. Appends what is new of the chunk. INVALID_FIELD ("chunk.data" empty or too large, "chunk.crc32c"
  // missing), OFFSET_OUT_OF_RANGE (with committed_offset), CHECKSUM_MISMATCH; errors of UploadWriter::Append. What was
  // committed before stays.
  absl::Status Append(const ReceivedChunk& chunk, Overlap overlap);

  // After the last byte: makes the payload a scan. OFFSET_OUT_OF_RANGE (bytes are missing), MEMORY_BUDGET,
  // DIGEST_MISMATCH and MALFORMED_PAYLOAD, which discard the upload; errors of UploadWriter. Only chunks that bring
  // nothing new may follow its success.
  absl::StatusOr<UploadWriter::Committed> Finish(const v1::Digest& declared);

  bool has_begun() const { return writer_ != nullptr || is_stored_; }
  const UploadDescription& description() const { return description_; }
  uint64_t committed_offset() const;
  bool is_complete() const { return committed_offset() == description_.payload_bytes; }

 private:
  absl::StatusOr<std::optional<StoredScan>> FindKnown() const;
  absl::Status BeginWriting();
  absl::Status CheckChunk(const ReceivedChunk& chunk, Overlap overlap, uint64_t size) const;
  absl::Status Store(std::span<const std::string_view> pieces, uint64_t num_skipped);
  absl::Status StoreBlock(std::span<const std::string_view> pieces);
  absl::StatusOr<UploadWriter::Committed> CheckAndCommit(const v1::Digest& declared);
  absl::StatusOr<UploadWriter::Committed> Commit(uint64_t finite_point_count, const std::string& content_digest);
  absl::Status CheckDigest(const v1::Digest& declared, const v1::Digest& actual) const;
  absl::Status OffsetError(std::string_view message) const;
  void Close();

  const UploadEnvironment& environment_;
  const std::stop_source replaced_;
  UploadDescription description_;
  bool is_stored_ = false;                // nothing more is written
  std::unique_ptr<UploadWriter> writer_;  // from Begin until the scan is stored
  // Counts over all bytes so far, where they are points as the core has them and all came in this stream: then nothing
  // needs to be read again and decoded at the end.
  std::optional<FinitePointCounter> finite_points_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_SCANS_SCAN_INTAKE_H_
