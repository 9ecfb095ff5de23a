// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The parts of a store, put together. For scan_store.cc, scan_changes.cc, store_recovery.cc, upload_writer.cc and
// nobody else.
#ifndef CURVEREG_SERVER_STORE_SCAN_STORE_IMPL_H_
#define CURVEREG_SERVER_STORE_SCAN_STORE_IMPL_H_

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "server/store/lost_files.h"
#include "server/store/payload_files.h"
#include "server/store/removal_marks.h"
#include "server/store/scan_catalog.h"
#include "server/store/scan_store.h"
#include "server/store/spare_space.h"
#include "server/store/store_file.h"
#include "server/store/store_space.h"
#include "server/store/upload_table.h"

namespace curvereg::server {

// What is kept open for as long as the store is.
struct StoreFolder {
  std::string path;
  StoreFile lock;
  PayloadFiles payloads;
  LostFiles lost;
  RemovalMarks removals;
  SpareSpace spare;
  std::unique_ptr<ScanCatalog> catalog;
};

class ScanStoreImpl final : public ScanStore {
 public:
  ScanStoreImpl(StoreFolder folder, const ScanStoreOptions& options);
  // Looks everything over, once, before any other call.
  absl::Status LookOver();

  absl::StatusOr<std::unique_ptr<UploadWriter>> BeginUpload(const UploadDescription& description) override;
  absl::StatusOr<UploadState> GetUpload(const std::string& upload_id) override;
  absl::StatusOr<int> ExpireUploads(std::chrono::system_clock::time_point now) override;
  absl::StatusOr<std::optional<StoredScan>> FindScan(const UploadDescription& description) override;
  absl::StatusOr<StoredScan> GetScan(const std::string& scan_id) override;
  absl::StatusOr<std::string> ReadPayload(const std::string& scan_id, uint64_t offset, uint64_t size) override;
  absl::StatusOr<std::string> ReadWholePayload(const std::string& scan_id) override;
  absl::Status CheckScan(const std::string& scan_id) override;
  absl::StatusOr<ScanPage> ListScans(int page_size, const std::string& page_token) override;
  absl::Status DeleteScan(const std::string& scan_id) override;
  absl::Status WithSpareSpace(const std::function<absl::Status()>& work) override;
  StoreStatistics Statistics() override;
  std::vector<std::string> DamagedScans() override;
  StoreFindings Findings() override { return {folder_.lost.num_taken(), uploads_.emptied()}; }

  // For writers. Makes a complete upload the scan `scan`. Precondition: upload.mutex is held.
  absl::StatusOr<UploadWriter::Committed> CommitUpload(Upload& upload, StoreFile& file, StoredScan scan);
  UploadTable& uploads() { return uploads_; }

 private:
  absl::StatusOr<UploadWriter::Committed> AddScan(Upload& upload, StoredScan scan, PayloadFiles::State state);
  absl::Status RemoveScan(const std::string& scan_id);
  // What the rows name.
  struct Named {
    std::set<std::string> payloads;  // digests
    std::set<FileIdentity> shared;   // payload files that have another name, too
  };
  void LookOverScan(const StoredScan& scan, Named& named);
  absl::Status SetOrphansAside(const Named& named);
  // Of a payload among lost files and marks.
  static std::string LabelOf(const std::string& digest);
  absl::Status SetAside(const std::string& path, const std::string& name);
  bool IsDamaged(const std::string& scan_id) const;
  // All scans with this payload.
  absl::Status MarkPayload(const std::string& digest, bool is_damaged);
  // Marks the payload of `scan`, too. Never OK.
  absl::Status FoundDamaged(const StoredScan& scan);
  absl::Status DamagedError(const std::string& scan_id) const;

  StoreFolder folder_;
  StoreSpace space_;
  UploadTable uploads_;
  std::atomic<uint64_t> num_scans_ = 0;
  std::mutex spare_mutex_;  // taken first
  // Taken by whoever changes which scans and payload files there are: both go together. After an Upload's.
  std::mutex scans_mutex_;
  mutable std::mutex damaged_mutex_;
  std::set<std::string> damaged_;
};

std::unique_ptr<UploadWriter> MakeUploadWriter(UploadTable::Grant grant, ScanStoreImpl& store);

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_STORE_SCAN_STORE_IMPL_H_
