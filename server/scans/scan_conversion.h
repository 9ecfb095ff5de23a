// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Resource names and stored scans, between the contract and the store.
#ifndef CURVEREG_SERVER_SCANS_SCAN_CONVERSION_H_
#define CURVEREG_SERVER_SCANS_SCAN_CONVERSION_H_

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "curvereg/v1/scan_service.pb.h"
#include "server/store/scan_store.h"

namespace curvereg::server {

std::string ScanName(std::string_view scan_id);      // "scans/ID"
std::string UploadName(std::string_view upload_id);  // "uploads/ID"

// The id in a name. INVALID_FIELD naming `field`: not "scans/" and 32 lower-case hexadecimal digits, or not "uploads/"
// and 1 to 64 of a-z, 0-9 and '-'.
absl::StatusOr<std::string> ScanIdOf(std::string_view name, std::string_view field);
absl::StatusOr<std::string> UploadIdOf(std::string_view name, std::string_view field);

v1::Scan ToWire(const StoredScan& scan);

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_SCANS_SCAN_CONVERSION_H_
