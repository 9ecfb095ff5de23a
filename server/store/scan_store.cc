// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/store/scan_store.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/store/page_token.h"
#include "server/store/scan_identity.h"
#include "server/store/scan_store_impl.h"
#include "wire/digest.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

constexpr char kLockName[] = "/lock";
constexpr char kDatabaseName[] = "/curvereg.db";
constexpr char kPayloadsName[] = "/payloads";
constexpr char kRemovalsName[] = "/removing";
constexpr char kSpareName[] = "/spare";
constexpr char kUploadsName[] = "/uploads";
constexpr int64_t kNewest = std::numeric_limits<int64_t>::max();

absl::Status NotFound(const std::string& scan_id) {
  return wire::MakeError(v1::ERROR_REASON_SCAN_NOT_FOUND, absl::StrCat("no scan of the name ", scan_id));
}

// Creates what is missing and locks it.
absl::StatusOr<StoreFolder> OpenFolder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(std::filesystem::path(path).parent_path(), error);
  if (absl::Status status = MakeFolder(path); !status.ok()) return status;
  absl::StatusOr<StoreFile> lock = StoreFile::OpenToWrite(path + kLockName);
  if (!lock.ok()) return lock.status();
  const absl::StatusOr<bool> is_locked = lock->TryLock();
  if (!is_locked.ok()) return is_locked.status();
  if (!*is_locked) return absl::FailedPreconditionError("another process has the data folder");
  absl::Status status = MakeFolder(path + kPayloadsName);
  if (status.ok()) status = MakeFolder(path + kUploadsName);
  if (status.ok()) status = SyncFolder(path);
  if (!status.ok()) return status;
  return StoreFolder{path,
                     *std::move(lock),
                     PayloadFiles(path + kPayloadsName),
                     LostFiles(ScanStore::LostFolder(path)),
                     RemovalMarks(path + kRemovalsName),
                     SpareSpace(path + kSpareName),
                     nullptr};
}

}  // namespace

absl::StatusOr<std::unique_ptr<ScanStore>> ScanStore::Open(const std::string& folder, const ScanStoreOptions& options) {
  const auto within_folder = [&](const absl::Status& status) {
    return absl::Status(status.code(), absl::StrCat(folder, ": ", status.message()));
  };
  absl::StatusOr<StoreFolder> opened = OpenFolder(folder);
  if (!opened.ok()) return within_folder(opened.status());
  const absl::StatusOr<std::vector<std::string>> payloads = opened->payloads.List();
  if (!payloads.ok()) return within_folder(payloads.status());
  absl::StatusOr<std::unique_ptr<ScanCatalog>> catalog = ScanCatalog::Open(folder + kDatabaseName, payloads->empty());
  if (absl::IsResourceExhausted(catalog.status())) {  // a full disk must not keep anybody from deleting
    opened->spare.GiveUp();
    catalog = ScanCatalog::Open(folder + kDatabaseName, payloads->empty());
  }
  if (!catalog.ok()) return catalog.status();
  opened->catalog = *std::move(catalog);
  opened->spare.Take();
  auto store = std::make_unique<ScanStoreImpl>(*std::move(opened), options);
  if (absl::Status status = store->LookOver(); !status.ok()) return within_folder(status);
  return store;
}

ScanStoreImpl::ScanStoreImpl(StoreFolder folder, const ScanStoreOptions& options)
    : folder_(std::move(folder)),
      space_(options.max_stored_bytes),
      uploads_(folder_.path + kUploadsName, options, *folder_.catalog, folder_.removals, space_) {}

absl::StatusOr<std::unique_ptr<UploadWriter>> ScanStoreImpl::BeginUpload(const UploadDescription& description) {
  absl::StatusOr<UploadTable::Grant> grant = uploads_.Begin(description);
  if (!grant.ok()) return grant.status();
  return MakeUploadWriter(*std::move(grant), *this);
}

absl::StatusOr<UploadState> ScanStoreImpl::GetUpload(const std::string& upload_id) { return uploads_.State(upload_id); }

absl::StatusOr<int> ScanStoreImpl::ExpireUploads(std::chrono::system_clock::time_point now) {
  return uploads_.Expire(now);
}

absl::StatusOr<std::optional<StoredScan>> ScanStoreImpl::FindScan(const UploadDescription& description) {
  const v1::Digest digest = description.payload_digest.value_or(v1::Digest());
  if (digest.algorithm() != v1::DIGEST_ALGORITHM_XXH3_128) return std::optional<StoredScan>();
  const std::string id = ScanId(description.header, digest);
  absl::StatusOr<std::optional<StoredScan>> scan = folder_.catalog->FindScan(id);
  // A damaged one is mended by sending it again.
  if (scan.ok() && scan->has_value() && ((*scan)->payload_bytes != description.payload_bytes || IsDamaged(id))) {
    return std::optional<StoredScan>();
  }
  return scan;
}

absl::StatusOr<StoredScan> ScanStoreImpl::GetScan(const std::string& scan_id) {
  absl::StatusOr<std::optional<StoredScan>> scan = folder_.catalog->FindScan(scan_id);
  if (!scan.ok()) return scan.status();
  if (!scan->has_value()) return NotFound(scan_id);
  return **std::move(scan);
}

absl::StatusOr<std::string> ScanStoreImpl::ReadPayload(const std::string& scan_id, uint64_t offset, uint64_t size) {
  const absl::StatusOr<StoredScan> scan = GetScan(scan_id);
  if (!scan.ok()) return scan.status();
  if (IsDamaged(scan_id)) return DamagedError(scan_id);
  if (offset > scan->payload_bytes) {
    return wire::MakeError(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE, "the offset lies beyond the end of the payload",
                           {{"payload_bytes", absl::StrCat(scan->payload_bytes)}});
  }
  const std::string& digest = scan->payload_digest.value();
  const uint64_t wanted = std::min(size, scan->payload_bytes - offset);
  absl::StatusOr<std::string> bytes = folder_.payloads.Read(digest, offset, wanted);
  if (bytes.ok() && bytes->size() == wanted) return bytes;
  // Deleted meanwhile, damaged, or a fault that passes?
  if (const absl::StatusOr<StoredScan> again = GetScan(scan_id); !again.ok()) return again.status();
  if (bytes.ok() || !folder_.payloads.HasSize(digest, scan->payload_bytes)) return FoundDamaged(*scan);
  return bytes;
}

absl::StatusOr<std::string> ScanStoreImpl::ReadWholePayload(const std::string& scan_id) {
  const absl::StatusOr<StoredScan> scan = GetScan(scan_id);
  if (!scan.ok()) return scan.status();
  absl::StatusOr<std::string> bytes = ReadPayload(scan_id, 0, scan->payload_bytes);
  if (!bytes.ok() || wire::SameDigest(wire::DigestOf(v1::DIGEST_ALGORITHM_XXH3_128, *bytes), scan->payload_digest)) {
    return bytes;
  }
  return FoundDamaged(*scan);
}

absl::StatusOr<ScanPage> ScanStoreImpl::ListScans(int page_size, const std::string& page_token) {
  const absl::StatusOr<int64_t> before = PlaceOf(page_token, kNewest);
  if (!before.ok()) return before.status();
  const int num_wanted = std::clamp(page_size, 1, kMaxPageSize);
  absl::StatusOr<std::vector<CatalogedScan>> scans = folder_.catalog->ListScans(*before, num_wanted + 1);
  if (!scans.ok()) return scans.status();
  ScanPage page;
  if (scans->size() > static_cast<std::size_t>(num_wanted)) {
    scans->pop_back();
    page.next_page_token = TokenOfPlace(scans->back().sequence);
  }
  for (CatalogedScan& scan : *scans) page.scans.push_back(std::move(scan.scan));
  return page;
}

StoreStatistics ScanStoreImpl::Statistics() {
  return {num_scans_.load(), uploads_.num_uploads(), space_.StoredBytes()};
}

}  // namespace curvereg::server
