// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What changes the scans of a store: commit and deletion.
#ifndef CURVEREG_SERVER_STORE_SCAN_CHANGES_H_
#define CURVEREG_SERVER_STORE_SCAN_CHANGES_H_

#include <mutex>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/store/damage_record.h"
#include "server/store/scan_store.h"
#include "server/store/store_folder.h"
#include "server/store/store_space.h"
#include "server/store/upload_table.h"

namespace curvereg::server {

// Safe to use from several threads.
class ScanChanges {
 public:
  // All outlive it.
  ScanChanges(StoreFolder& folder, StoreSpace& space, UploadTable& uploads, DamageRecord& damaged)
      : folder_(folder), space_(space), uploads_(uploads), damaged_(damaged) {}

  // Makes a complete upload, whose bytes are in `file`, the scan `scan`. Precondition: upload.mutex is held. Errors as
  // UploadWriter::Commit.
  absl::StatusOr<UploadWriter::Committed> CommitUpload(Upload& upload, StoreFile& file, StoredScan scan);
  absl::Status DeleteScan(const std::string& scan_id);  // SCAN_NOT_FOUND

 private:
  absl::StatusOr<UploadWriter::Committed> AddScan(Upload& upload, StoredScan scan, PayloadFiles::State state);
  absl::Status RemoveScan(const std::string& scan_id);

  StoreFolder& folder_;
  StoreSpace& space_;
  UploadTable& uploads_;
  DamageRecord& damaged_;
  std::mutex mutex_;  // scans and payload files change together; taken after an Upload's
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_STORE_SCAN_CHANGES_H_
