// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/scans/scan_conversion.h"

#include <algorithm>

#include "wire/error.h"
#include "wire/timestamp.h"

namespace curvereg::server {
namespace {

constexpr std::string_view kScans = "scans/";
constexpr std::string_view kUploads = "uploads/";
constexpr size_t kScanIdDigits = 32;
constexpr size_t kMaxUploadIdLength = 64;

bool IsDigit(char c) { return c >= '0' && c <= '9'; }
bool IsHexDigit(char c) { return IsDigit(c) || (c >= 'a' && c <= 'f'); }
bool IsUploadIdCharacter(char c) { return IsDigit(c) || (c >= 'a' && c <= 'z') || c == '-'; }

}  // namespace

std::string ScanName(std::string_view scan_id) { return std::string(kScans).append(scan_id); }

std::string UploadName(std::string_view upload_id) { return std::string(kUploads).append(upload_id); }

absl::StatusOr<std::string> ScanIdOf(std::string_view name, std::string_view field) {
  if (name.starts_with(kScans)) {
    name.remove_prefix(kScans.size());
    if (name.size() == kScanIdDigits && std::all_of(name.begin(), name.end(), IsHexDigit)) return std::string(name);
  }
  return wire::FieldError(field, "must be scans/ and 32 lower-case hexadecimal digits");
}

absl::StatusOr<std::string> UploadIdOf(std::string_view name, std::string_view field) {
  if (name.starts_with(kUploads)) {
    name.remove_prefix(kUploads.size());
    if (!name.empty() && name.size() <= kMaxUploadIdLength &&
        std::all_of(name.begin(), name.end(), IsUploadIdCharacter)) {
      return std::string(name);
    }
  }
  return wire::FieldError(field, "must be uploads/ and 1 to 64 of a-z, 0-9 and '-'");
}

v1::Scan ToWire(const StoredScan& scan) {
  v1::Scan message;
  message.set_name(ScanName(scan.id));
  *message.mutable_header() = scan.header;
  message.set_payload_bytes(scan.payload_bytes);
  *message.mutable_payload_digest() = scan.payload_digest;
  message.set_finite_point_count(scan.finite_point_count);
  message.set_content_digest(scan.content_digest);
  *message.mutable_create_time() = wire::TimestampOf(scan.create_time);
  return message;
}

}  // namespace curvereg::server
