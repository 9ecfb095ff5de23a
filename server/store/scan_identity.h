// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What makes two scans the same: header and payload.
#ifndef CURVEREG_SERVER_STORE_SCAN_IDENTITY_H_
#define CURVEREG_SERVER_STORE_SCAN_IDENTITY_H_

#include <string>

#include "curvereg/v1/point_cloud.pb.h"

namespace curvereg::server {

// Every field of a header as bytes, the same for equal headers whatever version of protobuf wrote them (its own
// serialisation promises no such thing). Numbers little-endian, doubles by their bits, text after its length, a byte
// before each message that tells whether it is there.
std::string CanonicalHeader(const v1::PointCloudHeader& header);

// 32 hexadecimal digits: XXH3_128 of the canonical header and the payload's XXH3_128 digest. Kept on disk and in
// clients' hands, so it never changes.
std::string ScanId(const v1::PointCloudHeader& header, const v1::Digest& payload_digest);

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_STORE_SCAN_IDENTITY_H_
