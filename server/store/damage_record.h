// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Which scans of a store were found damaged. Not kept on disk: they are found again.
#ifndef CURVEREG_SERVER_STORE_DAMAGE_RECORD_H_
#define CURVEREG_SERVER_STORE_DAMAGE_RECORD_H_

#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "server/store/scan_catalog.h"

namespace curvereg::server {

// Safe to use from several threads.
class DamageRecord {
 public:
  // The catalog outlives it.
  explicit DamageRecord(ScanCatalog& catalog) : catalog_(catalog) {}

  bool Contains(const std::string& scan_id) const;
  std::vector<std::string> Ids() const;

  void Add(const std::string& scan_id);
  void Remove(const std::string& scan_id);
  // All scans with this payload. Errors of the catalog.
  absl::Status AddPayload(const std::string& digest);
  absl::Status RemovePayload(const std::string& digest);
  // Adds all scans with the payload of this one. Never OK: STORED_SCAN_DAMAGED, or an error of the catalog.
  absl::Status Found(const StoredScan& scan);

  static absl::Status Error(const std::string& scan_id);  // STORED_SCAN_DAMAGED

 private:
  ScanCatalog& catalog_;
  mutable std::mutex mutex_;
  std::set<std::string> ids_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_STORE_DAMAGE_RECORD_H_
