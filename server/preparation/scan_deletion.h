// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The one place that deletes a stored scan: from the store, and what is prepared of it from the cache.
#ifndef CURVEREG_SERVER_PREPARATION_SCAN_DELETION_H_
#define CURVEREG_SERVER_PREPARATION_SCAN_DELETION_H_

#include <string>

#include "absl/status/status.h"
#include "server/preparation/prepared_scan_cache.h"
#include "server/store/scan_store.h"

namespace curvereg::server {

// Errors of ScanStore::DeleteScan. The cache has nothing of the scan afterwards, also when the store had no such scan
// (SCAN_NOT_FOUND).
absl::Status DeleteStoredScan(const std::string& scan_id, ScanStore& store, PreparedScanCache& cache);

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_PREPARATION_SCAN_DELETION_H_
