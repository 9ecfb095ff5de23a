// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What changes the scans of a store: commit, deletion, damage.
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/store/scan_store_impl.h"
#include "wire/digest.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

constexpr uint64_t kCheckedBytes = uint64_t{1} << 20;  // read at once

}  // namespace

absl::StatusOr<UploadWriter::Committed> ScanStoreImpl::CommitUpload(Upload& upload, StoreFile& file, StoredScan scan) {
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

absl::StatusOr<UploadWriter::Committed> ScanStoreImpl::AddScan(Upload& upload, StoredScan scan,
                                                               PayloadFiles::State state) {
  const std::string& digest = scan.payload_digest.value();
  const std::lock_guard lock(scans_mutex_);
  const absl::StatusOr<std::optional<StoredScan>> known = folder_.catalog->FindScan(scan.id);
  if (!known.ok()) return known.status();
  const absl::StatusOr<std::vector<std::string>> sharing = folder_.catalog->ScansWithPayload(digest);
  if (!sharing.ok()) return sharing.status();
  const std::string source = uploads_.PathOf(upload.description.id);
  folder_.removals.Clear(LabelOf(digest));  // of one that could not be removed
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
    ++num_scans_;
    if (sharing->empty()) space_.AddPayload(scan.payload_bytes);
    uploads_.End(upload);
  }
  if (!sharing->empty()) {
    if (absl::Status mended = MarkPayload(digest, false); !mended.ok()) return mended;
  }
  return UploadWriter::Committed{known->value_or(std::move(scan)), known->has_value()};
}

absl::Status ScanStoreImpl::DeleteScan(const std::string& scan_id) {
  return WithSpareSpace([&] { return RemoveScan(scan_id); });
}

absl::Status ScanStoreImpl::WithSpareSpace(const std::function<absl::Status()>& work) {
  const std::lock_guard lock(spare_mutex_);
  absl::Status status = work();
  if (absl::IsResourceExhausted(status)) {
    folder_.spare.GiveUp();
    status = work();
  }
  folder_.spare.Take();
  return status;
}

absl::Status ScanStoreImpl::RemoveScan(const std::string& scan_id) {
  const std::lock_guard lock(scans_mutex_);
  const absl::StatusOr<StoredScan> scan = GetScan(scan_id);
  if (!scan.ok()) return scan.status();
  const std::string& digest = scan->payload_digest.value();
  const absl::StatusOr<std::vector<std::string>> sharing = folder_.catalog->ScansWithPayload(digest);
  if (!sharing.ok()) return sharing.status();
  const bool is_last = sharing->size() == 1;
  const std::string label = LabelOf(digest);
  if (is_last) folder_.removals.Set(folder_.payloads.PathOf(digest), label);
  if (absl::Status status = folder_.catalog->RemoveScan(scan_id); !status.ok()) {
    if (is_last) folder_.removals.Clear(label);
    return status;
  }
  --num_scans_;
  if (is_last) {
    // A file that stays behind is removed at the next start.
    if (folder_.payloads.Remove(digest).ok()) folder_.removals.Clear(label);
    space_.RemovePayload(scan->payload_bytes);
  }
  const std::lock_guard damaged_lock(damaged_mutex_);
  damaged_.erase(scan_id);
  return absl::OkStatus();
}

std::string ScanStoreImpl::LabelOf(const std::string& digest) { return "payload-" + wire::HexText(digest); }

bool ScanStoreImpl::IsDamaged(const std::string& scan_id) const {
  const std::lock_guard lock(damaged_mutex_);
  return damaged_.contains(scan_id);
}

absl::Status ScanStoreImpl::MarkPayload(const std::string& digest, bool is_damaged) {
  const absl::StatusOr<std::vector<std::string>> scans = folder_.catalog->ScansWithPayload(digest);
  if (!scans.ok()) return scans.status();
  const std::lock_guard lock(damaged_mutex_);
  for (const std::string& id : *scans) {
    if (is_damaged) {
      damaged_.insert(id);
    } else {
      damaged_.erase(id);
    }
  }
  return absl::OkStatus();
}

absl::Status ScanStoreImpl::CheckScan(const std::string& scan_id) {
  const absl::StatusOr<StoredScan> scan = GetScan(scan_id);
  if (!scan.ok()) return scan.status();
  absl::StatusOr<wire::Digester> digester = wire::Digester::Create(v1::DIGEST_ALGORITHM_XXH3_128);
  if (!digester.ok()) return digester.status();
  for (uint64_t offset = 0; offset < scan->payload_bytes; offset += kCheckedBytes) {
    const absl::StatusOr<std::string> piece = ReadPayload(scan_id, offset, kCheckedBytes);
    if (!piece.ok()) return piece.status();
    digester->Update(*piece);
  }
  return wire::SameDigest(digester->Digest(), scan->payload_digest) ? absl::OkStatus() : FoundDamaged(*scan);
}

absl::Status ScanStoreImpl::FoundDamaged(const StoredScan& scan) {
  const absl::Status marked = MarkPayload(scan.payload_digest.value(), true);
  return marked.ok() ? DamagedError(scan.id) : marked;
}

absl::Status ScanStoreImpl::DamagedError(const std::string& scan_id) const {
  return wire::MakeError(v1::ERROR_REASON_STORED_SCAN_DAMAGED,
                         absl::StrCat("the stored bytes of ", scan_id, " are damaged; upload it again"));
}

std::vector<std::string> ScanStoreImpl::DamagedScans() {
  const std::lock_guard lock(damaged_mutex_);
  return {damaged_.begin(), damaged_.end()};
}

}  // namespace curvereg::server
