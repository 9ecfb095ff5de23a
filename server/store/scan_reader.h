// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Reads the scans of a store. Damage that it meets is remembered.
#ifndef CURVEREG_SERVER_STORE_SCAN_READER_H_
#define CURVEREG_SERVER_STORE_SCAN_READER_H_

#include <cstdint>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/store/damage_record.h"
#include "server/store/scan_store.h"
#include "server/store/store_folder.h"

namespace curvereg::server {

// Each function as that of ScanStore. Safe to use from several threads.
class ScanReader {
 public:
  // Both outlive it.
  ScanReader(const StoreFolder& folder, DamageRecord& damaged) : folder_(folder), damaged_(damaged) {}

  absl::StatusOr<std::optional<StoredScan>> FindScan(const UploadDescription& description);
  absl::StatusOr<std::string> ReadPayload(const std::string& scan_id, uint64_t offset, uint64_t size);
  absl::StatusOr<std::string> ReadWholePayload(const std::string& scan_id);
  absl::Status CheckScan(const std::string& scan_id);
  absl::StatusOr<ScanPage> ListScans(int page_size, const std::string& page_token);

 private:
  const StoreFolder& folder_;
  DamageRecord& damaged_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_STORE_SCAN_READER_H_
