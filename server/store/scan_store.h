// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Scans on disk: one folder with an SQLite database (WAL) of names and offsets, files named by digest for payloads, and
// one file for each unfinished upload. What a function answered OK for survives the death of the process; a committed
// scan survives a loss of power, too. Safe to use from several threads. One process at a time: the folder is locked.
#ifndef CURVEREG_SERVER_STORE_SCAN_STORE_H_
#define CURVEREG_SERVER_STORE_SCAN_STORE_H_

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "curvereg/v1/point_cloud.pb.h"

namespace curvereg::server {

struct ScanStoreOptions {
  uint64_t max_stored_bytes = uint64_t{50} << 30;  // payloads and unfinished uploads; beyond it STORAGE_FULL
  int max_uploads = 1024;                          // unfinished ones; beyond it TOO_MANY_UPLOADS
  std::chrono::seconds upload_lifetime = std::chrono::hours(24 * 7);  // without progress; then forgotten
};

// A committed scan.
struct StoredScan {
  std::string id;  // 32 hexadecimal digits, of header and payload
  v1::PointCloudHeader header;
  uint64_t payload_bytes = 0;
  v1::Digest payload_digest;  // XXH3_128
  uint64_t finite_point_count = 0;
  std::string content_digest;  // ScanDigest of the decoded points and gravity
  std::chrono::system_clock::time_point create_time;
};

// What an upload is begun with; the same when it is resumed.
struct UploadDescription {
  std::string id;
  v1::PointCloudHeader header;
  uint64_t payload_bytes = 0;
  std::optional<v1::Digest> payload_digest;
};

struct UploadState {
  UploadDescription description;
  uint64_t committed_offset = 0;
  std::chrono::system_clock::time_point expire_time;
};

struct StoreStatistics {
  uint64_t num_scans = 0;
  uint64_t num_uploads = 0;
  uint64_t stored_bytes = 0;  // payloads and unfinished uploads
};

// What was wrong when the store was opened, besides damaged scans.
struct RecoveryReport {
  // Files with bytes that may have been acknowledged, but that no row named: they were moved to OrphanFolder.
  uint64_t num_orphaned_files = 0;
  std::vector<std::string> emptied_uploads;  // ids of unfinished uploads whose bytes were gone: they continue at 0
};

struct ScanPage {
  std::vector<StoredScan> scans;  // newest first
  std::string next_page_token;    // empty: the last page
};

class UploadWriter;

class ScanStore {
 public:
  // Creates the folder if need be, locks it, and recovers the store: what an interrupted commit or deletion left behind
  // is removed, other files that no row names are set aside (see Recovery), rows whose file is missing or of
  // another size are reported by DamagedScans() and refused on reading. DATA_LOSS: the database itself is damaged,
  // message names it; FAILED_PRECONDITION: another process has the folder, or a newer version made it; others: the
  // folder cannot be used.
  static absl::StatusOr<std::unique_ptr<ScanStore>> Open(const std::string& folder, const ScanStoreOptions& options);
  virtual ~ScanStore() = default;
  // Where orphaned files are kept until an operator has looked at them.
  static std::string OrphanFolder(const std::string& folder) { return folder + "/lost"; }

  // Begins or resumes. The writer given out before for this upload is fenced off: its calls fail with WRITER_REPLACED.
  // Coming back counts as progress. INVALID_FIELD "upload" or "payload_bytes" (0), UPLOAD_DIFFERS, TOO_MANY_UPLOADS,
  // STORAGE_FULL (the declared bytes do not fit; they are set aside for it), STORAGE_FAULT.
  virtual absl::StatusOr<std::unique_ptr<UploadWriter>> BeginUpload(const UploadDescription& description) = 0;
  virtual absl::StatusOr<UploadState> GetUpload(const std::string& upload_id) = 0;  // UPLOAD_NOT_FOUND
  // Forgets uploads past their lifetime; returns how many.
  virtual absl::StatusOr<int> ExpireUploads(std::chrono::system_clock::time_point now) = 0;

  // A scan with this header and a payload of this XXH3_128 digest and size, if there is one.
  virtual absl::StatusOr<std::optional<StoredScan>> FindScan(const UploadDescription& description) = 0;
  virtual absl::StatusOr<StoredScan> GetScan(const std::string& scan_id) = 0;  // SCAN_NOT_FOUND
  // `size` bytes from `offset`, fewer at the end. SCAN_NOT_FOUND, OFFSET_OUT_OF_RANGE, STORED_SCAN_DAMAGED.
  virtual absl::StatusOr<std::string> ReadPayload(const std::string& scan_id, uint64_t offset, uint64_t size) = 0;
  // The whole payload, its digest checked: STORED_SCAN_DAMAGED when it differs.
  virtual absl::StatusOr<std::string> ReadWholePayload(const std::string& scan_id) = 0;
  // Reads the whole payload, a piece at a time, and checks its digest: STORED_SCAN_DAMAGED, which is remembered;
  // SCAN_NOT_FOUND. For who has found damage.
  virtual absl::Status CheckScan(const std::string& scan_id) = 0;
  // INVALID_FIELD "page_token": not one of ours.
  virtual absl::StatusOr<ScanPage> ListScans(int page_size, const std::string& page_token) = 0;
  virtual absl::Status DeleteScan(const std::string& scan_id) = 0;  // SCAN_NOT_FOUND
  // For what else is kept on the same disk: runs `work`, a deletion for example, and where the disk is full
  // (RESOURCE_EXHAUSTED) runs it again with the space that is set aside for deletions. One at a time; `work` must not
  // delete scans.
  virtual absl::Status WithReservedSpace(const std::function<absl::Status()>& work) = 0;

  virtual StoreStatistics Statistics() = 0;
  // Ids of scans found damaged at start-up or since.
  virtual std::vector<std::string> DamagedScans() = 0;
  virtual RecoveryReport Recovery() = 0;
};

// The right to continue one upload, until another writer of the same upload is begun. Used by one thread at a time.
// Destroying it leaves what is committed. Must not outlive the store.
class UploadWriter {
 public:
  virtual ~UploadWriter() = default;
  virtual uint64_t committed_offset() const = 0;
  // Appends at the committed offset, which then is safe from the death of the process. OFFSET_OUT_OF_RANGE,
  // WRITER_REPLACED, STORAGE_FULL (disk full: the committed offset is unchanged), STORAGE_FAULT.
  virtual absl::Status Append(uint64_t offset, std::span<const std::string_view> pieces) = 0;
  absl::Status Append(uint64_t offset, std::string_view bytes) { return Append(offset, {&bytes, 1}); }
  // All bytes so far. For checking before Commit.
  virtual absl::StatusOr<std::string> ReadAll() = 0;
  // XXH3_128 of all bytes so far.
  virtual absl::StatusOr<v1::Digest> PayloadDigest() = 0;
  // Makes the payload a scan, durably, unless the same scan is there already (then `already_stored`), and ends the
  // upload. Precondition: complete and checked. WRITER_REPLACED, STORAGE_FULL, STORAGE_FAULT.
  struct Committed {
    StoredScan scan;
    bool already_stored = false;
  };
  virtual absl::StatusOr<Committed> Commit(uint64_t finite_point_count, const std::string& content_digest) = 0;
  // Ends the upload and forgets its bytes: what came cannot be right.
  virtual absl::Status Discard() = 0;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_STORE_SCAN_STORE_H_
