// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/preparation/scan_deletion.h"

#include "wire/error.h"
#include "wire/resource_names.h"

namespace curvereg::server {

absl::Status DeleteStoredScan(const std::string& scan_id, ScanStore& store, PreparedScanCache& cache) {
  absl::Status deleted = store.DeleteScan(scan_id);
  if (deleted.ok() || wire::ReasonOf(deleted) == v1::ERROR_REASON_SCAN_NOT_FOUND) cache.Erase(wire::ScanName(scan_id));
  return deleted;
}

}  // namespace curvereg::server
