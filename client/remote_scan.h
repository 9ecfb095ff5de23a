// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Scans of the library's interface to and from the contract.
#ifndef CURVEREG_CLIENT_REMOTE_SCAN_H_
#define CURVEREG_CLIENT_REMOTE_SCAN_H_

#include "absl/status/statusor.h"
#include "client/client.h"
#include "core/scan/scan.h"
#include "curvereg/v1/point_cloud.pb.h"
#include "curvereg/v1/registration_service.pb.h"
#include "curvereg/v1/scan_service.pb.h"

namespace curvereg::internal {

RemoteScan FromWire(const v1::Scan& scan);

// Errors of wire::EncodeScan.
absl::StatusOr<v1::PointCloud> EncodeFor(const TransferEncoding& encoding, const curvereg::Scan& scan);

// Inline, or by name. INVALID_ARGUMENT: an empty name; errors of EncodeFor.
absl::StatusOr<v1::ScanInput> ScanInputOf(const ScanReference& reference, const TransferEncoding& encoding);

}  // namespace curvereg::internal

#endif  // CURVEREG_CLIENT_REMOTE_SCAN_H_
