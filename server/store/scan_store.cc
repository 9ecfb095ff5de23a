// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/store/scan_store.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "server/store/damage_record.h"
#include "server/store/scan_changes.h"
#include "server/store/scan_reader.h"
#include "server/store/store_folder.h"
#include "server/store/store_recovery.h"
#include "server/store/store_space.h"
#include "server/store/upload_table.h"
#include "server/store/upload_writer.h"

namespace curvereg::server {
namespace {

// The parts of a store, put together.
class ScanStoreImpl final : public ScanStore {
 public:
  ScanStoreImpl(std::unique_ptr<StoreFolder> folder, const ScanStoreOptions& options)
      : folder_(std::move(folder)),
        space_(options.max_stored_bytes),
        damaged_(*folder_->catalog),
        uploads_(folder_->uploads_path(), options, *folder_->catalog, folder_->removals, space_),
        reader_(*folder_, damaged_),
        changes_(*folder_, space_, uploads_, damaged_) {}

  // Once, before any other call.
  absl::Status Recover() {
    absl::StatusOr<RecoveryReport> report = StoreRecovery(*folder_, space_, uploads_, damaged_).Recover();
    if (report.ok()) recovery_ = *std::move(report);
    return report.status();
  }

  absl::StatusOr<std::unique_ptr<UploadWriter>> BeginUpload(const UploadDescription& description) override {
    absl::StatusOr<UploadTable::Grant> grant = uploads_.Begin(description);
    if (!grant.ok()) return grant.status();
    return MakeUploadWriter(*std::move(grant), uploads_, changes_);
  }
  absl::StatusOr<UploadState> GetUpload(const std::string& upload_id) override { return uploads_.State(upload_id); }
  absl::StatusOr<int> ExpireUploads(std::chrono::system_clock::time_point now) override { return uploads_.Expire(now); }

  absl::StatusOr<std::optional<StoredScan>> FindScan(const UploadDescription& description) override {
    return reader_.FindScan(description);
  }
  absl::StatusOr<StoredScan> GetScan(const std::string& scan_id) override { return folder_->catalog->GetScan(scan_id); }
  absl::StatusOr<std::string> ReadPayload(const std::string& scan_id, uint64_t offset, uint64_t size) override {
    return reader_.ReadPayload(scan_id, offset, size);
  }
  absl::StatusOr<std::string> ReadWholePayload(const std::string& scan_id) override {
    return reader_.ReadWholePayload(scan_id);
  }
  absl::Status CheckScan(const std::string& scan_id) override { return reader_.CheckScan(scan_id); }
  absl::StatusOr<ScanPage> ListScans(int page_size, const std::string& page_token) override {
    return reader_.ListScans(page_size, page_token);
  }
  absl::Status DeleteScan(const std::string& scan_id) override { return changes_.DeleteScan(scan_id); }
  absl::Status WithReservedSpace(const std::function<absl::Status()>& work) override {
    return folder_->reserved.Use(work);
  }

  StoreStatistics Statistics() override { return {space_.num_scans(), uploads_.num_uploads(), space_.StoredBytes()}; }
  std::vector<std::string> DamagedScans() override { return damaged_.Ids(); }
  RecoveryReport Recovery() override { return recovery_; }

 private:
  const std::unique_ptr<StoreFolder> folder_;
  StoreSpace space_;
  DamageRecord damaged_;
  UploadTable uploads_;
  ScanReader reader_;
  ScanChanges changes_;
  RecoveryReport recovery_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<ScanStore>> ScanStore::Open(const std::string& folder, const ScanStoreOptions& options) {
  absl::StatusOr<std::unique_ptr<StoreFolder>> opened = StoreFolder::Open(folder);
  if (!opened.ok()) return opened.status();
  auto store = std::make_unique<ScanStoreImpl>(*std::move(opened), options);
  if (absl::Status status = store->Recover(); !status.ok()) {
    return absl::Status(status.code(), absl::StrCat(folder, ": ", status.message()));
  }
  return store;
}

}  // namespace curvereg::server
