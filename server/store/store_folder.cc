// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/store/store_folder.h"

#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "server/store/scan_store.h"
#include "wire/digest.h"

namespace curvereg::server {
namespace {

constexpr char kLockName[] = "/lock";
constexpr char kDatabaseName[] = "/curvereg.db";
constexpr char kPayloadsName[] = "/payloads";
constexpr char kRemovalsName[] = "/removing";
constexpr char kReservedName[] = "/spare";

absl::StatusOr<std::unique_ptr<StoreFolder>> LockFolder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(std::filesystem::path(path).parent_path(), error);
  if (absl::Status status = MakeFolder(path); !status.ok()) return status;
  absl::StatusOr<StoreFile> lock = StoreFile::OpenToWrite(path + kLockName);
  if (!lock.ok()) return lock.status();
  const absl::StatusOr<bool> is_locked = lock->TryLock();
  if (!is_locked.ok()) return is_locked.status();
  if (!*is_locked) return absl::FailedPreconditionError("another process has the data folder");
  auto folder = std::make_unique<StoreFolder>(path, *std::move(lock));
  absl::Status status = MakeFolder(path + kPayloadsName);
  if (status.ok()) status = MakeFolder(folder->uploads_path());
  if (status.ok()) status = SyncFolder(path);
  if (!status.ok()) return status;
  return folder;
}

}  // namespace

StoreFolder::StoreFolder(const std::string& folder, StoreFile lock_file)
    : path(folder),
      lock(std::move(lock_file)),
      payloads(folder + kPayloadsName),
      orphaned(ScanStore::OrphanFolder(folder)),
      removals(folder + kRemovalsName),
      reserved(folder + kReservedName) {}

absl::StatusOr<std::unique_ptr<StoreFolder>> StoreFolder::Open(const std::string& path) {
  const auto within_folder = [&](const absl::Status& status) {
    return absl::Status(status.code(), absl::StrCat(path, ": ", status.message()));
  };
  absl::StatusOr<std::unique_ptr<StoreFolder>> folder = LockFolder(path);
  if (!folder.ok()) return within_folder(folder.status());
  const absl::StatusOr<std::vector<std::string>> payloads = (*folder)->payloads.List();
  if (!payloads.ok()) return within_folder(payloads.status());
  absl::StatusOr<std::unique_ptr<ScanCatalog>> catalog = ScanCatalog::Open(path + kDatabaseName, payloads->empty());
  if (absl::IsResourceExhausted(catalog.status())) {  // a full disk must not keep anybody from deleting
    (*folder)->reserved.GiveUp();
    catalog = ScanCatalog::Open(path + kDatabaseName, payloads->empty());
  }
  if (!catalog.ok()) return catalog.status();
  (*folder)->catalog = *std::move(catalog);
  (*folder)->reserved.Take();
  return folder;
}

std::string StoreFolder::LabelOf(const std::string& digest) { return "payload-" + wire::HexText(digest); }

}  // namespace curvereg::server
