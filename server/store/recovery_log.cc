// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/store/recovery_log.h"

#include <cstdint>

#include "wire/resource_names.h"

namespace curvereg::server {

void LogRecovery(ScanStore& store, const std::string& folder, Logger& logger) {
  for (const std::string& id : store.DamagedScans()) logger.Error("damaged_scan", {{"scan", wire::ScanName(id)}});
  const RecoveryReport report = store.Recovery();
  if (report.num_orphaned_files > 0) {
    logger.Error("files_lost", {{"count", static_cast<int64_t>(report.num_orphaned_files)},
                                {"folder", ScanStore::OrphanFolder(folder)}});
  }
  for (const std::string& id : report.emptied_uploads) {
    logger.Error("upload_emptied", {{"upload", wire::UploadName(id)}});
  }
  const StoreStatistics statistics = store.Statistics();
  logger.Info("store_opened", {{"data_dir", folder},
                               {"scans", static_cast<int64_t>(statistics.num_scans)},
                               {"uploads", static_cast<int64_t>(statistics.num_uploads)},
                               {"bytes", static_cast<int64_t>(statistics.stored_bytes)}});
}

}  // namespace curvereg::server
