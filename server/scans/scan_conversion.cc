// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/scans/scan_conversion.h"

#include "wire/resource_names.h"
#include "wire/timestamp.h"

namespace curvereg::server {

v1::Scan ToWire(const StoredScan& scan) {
  v1::Scan message;
  message.set_name(wire::ScanName(scan.id));
  *message.mutable_header() = scan.header;
  message.set_payload_bytes(scan.payload_bytes);
  *message.mutable_payload_digest() = scan.payload_digest;
  message.set_finite_point_count(scan.finite_point_count);
  message.set_content_digest(scan.content_digest);
  *message.mutable_create_time() = wire::TimestampOf(scan.create_time);
  return message;
}

}  // namespace curvereg::server
