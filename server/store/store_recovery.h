// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What a store does when it is opened: it compares rows and files, and takes over what an earlier process left.
#ifndef CURVEREG_SERVER_STORE_STORE_RECOVERY_H_
#define CURVEREG_SERVER_STORE_STORE_RECOVERY_H_

#include <set>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/store/damage_record.h"
#include "server/store/scan_store.h"
#include "server/store/store_folder.h"
#include "server/store/store_space.h"
#include "server/store/upload_table.h"

namespace curvereg::server {

class StoreRecovery {
 public:
  // All outlive it. `space` counts what is found, `uploads` takes over unfinished ones, `damaged` the scans whose file
  // is missing or of another size.
  StoreRecovery(StoreFolder& folder, StoreSpace& space, UploadTable& uploads, DamageRecord& damaged)
      : folder_(folder), space_(space), uploads_(uploads), damaged_(damaged) {}

  // Once, before anything else is done with the store. Errors of files and database.
  absl::StatusOr<RecoveryReport> Recover();

 private:
  void RecoverScan(const StoredScan& scan);
  absl::Status SetOrphansAside();
  absl::Status SetAside(const std::string& path, const std::string& name);

  StoreFolder& folder_;
  StoreSpace& space_;
  UploadTable& uploads_;
  DamageRecord& damaged_;
  // What the rows name.
  std::set<std::string> payloads_;  // digests
  std::set<FileIdentity> shared_;   // payload files that have another name, too
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_STORE_STORE_RECOVERY_H_
