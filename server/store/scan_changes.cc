// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/store/scan_changes.h"

#include <optional>
#include <utility>
#include <vector>

#include "wire/error.h"

namespace curvereg::server {

absl::StatusOr<UploadWriter::Committed> ScanChanges::CommitUpload(Upload& upload, StoreFile& file, StoredScan scan) {
  const absl::StatusOr<uint64_t> size = file.Size();
  if (!size.ok()) return size.status();
  if (*size != scan.payload_bytes) {
    return wire::MakeError(v1::ERROR_REASON_STORAGE_FAULT, "the upload's file is not as long as what was written");
  }
  if (absl::Status status = file.SyncData(); !status.ok()) {
    // The kernel may have dropped bytes and would not say so again: none of them can be relied on.
    uploads_.Drop(upload);
    return status;
  }
  // Reading what is there already takes long, so it is done before others have to wait.
  const PayloadFiles::State state = folder_.payloads.Check(scan.payload_digest.value(), scan.payload_bytes);
  return AddScan(upload, std::move(scan), state);
}

absl::StatusOr<UploadWriter::Committed> ScanChanges::AddScan(Upload& upload, StoredScan scan,
                                                             PayloadFiles::State state) {
  const std::string& digest = scan.payload_digest.value();
  const std::lock_guard lock(mutex_);
  const absl::StatusOr<std::optional<StoredScan>> known = folder_.catalog->FindScan(scan.id);
  if (!known.ok()) return known.status();
  const absl::StatusOr<std::vector<std::string>> sharing = folder_.catalog->ScansWithPayload(digest);
  if (!sharing.ok()) return sharing.status();
  const std::string source = uploads_.PathOf(upload.description.id);
  folder_.removals.Clear(StoreFolder::LabelOf(digest));  // of one that could not be removed
  absl::Status status = folder_.payloads.Add(digest, source, state == PayloadFiles::State::kDamaged);
  if (!status.ok()) return status;
  if (known->has_value()) {
    uploads_.Drop(upload);
  } else {
    status = folder_.catalog->AddScan(scan, upload.description.id);
    if (!status.ok()) {
      // After a fault the row may show up at the next start and then needs its file; a full disk leaves none.
      const bool is_full = wire::ReasonOf(status) == v1::ERROR_REASON_STORAGE_FULL;
      if (is_full && sharing->empty()) static_cast<void>(folder_.payloads.Remove(digest));
      return status;
    }
    space_.AddScan();
    if (sharing->empty()) space_.AddPayload(scan.payload_bytes);
    uploads_.End(upload);
  }
  if (!sharing->empty()) {
    if (absl::Status repaired = damaged_.RemovePayload(digest); !repaired.ok()) return repaired;
  }
  return UploadWriter::Committed{known->value_or(std::move(scan)), known->has_value()};
}

absl::Status ScanChanges::DeleteScan(const std::string& scan_id) {
  return folder_.reserved.Use([&] { return RemoveScan(scan_id); });
}

absl::Status ScanChanges::RemoveScan(const std::string& scan_id) {
  const std::lock_guard lock(mutex_);
  const absl::StatusOr<StoredScan> scan = folder_.catalog->GetScan(scan_id);
  if (!scan.ok()) return scan.status();
  const std::string& digest = scan->payload_digest.value();
  const absl::StatusOr<std::vector<std::string>> sharing = folder_.catalog->ScansWithPayload(digest);
  if (!sharing.ok()) return sharing.status();
  const bool is_last = sharing->size() == 1;
  const std::string label = StoreFolder::LabelOf(digest);
  if (is_last) folder_.removals.Set(folder_.payloads.PathOf(digest), label);
  if (absl::Status status = folder_.catalog->RemoveScan(scan_id); !status.ok()) {
    if (is_last) folder_.removals.Clear(label);
    return status;
  }
  space_.RemoveScan();
  if (is_last) {
    // A file that stays behind is removed at the next start.
    if (folder_.payloads.Remove(digest).ok()) folder_.removals.Clear(label);
    space_.RemovePayload(scan->payload_bytes);
  }
  damaged_.Remove(scan_id);
  return absl::OkStatus();
}

}  // namespace curvereg::server
