// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Traverses of the library's interface to and from the contract. The server is not trusted: what makes no sense is
// INTERNAL, for it is not the caller's fault.
#ifndef CURVEREG_CLIENT_TRAVERSE_CONVERSION_H_
#define CURVEREG_CLIENT_TRAVERSE_CONVERSION_H_

#include "absl/status/statusor.h"
#include "client/traverses.h"
#include "curvereg/v1/traverse_service.pb.h"

namespace curvereg::internal {

v1::TraverseSettings ToWire(const TraverseSettings& settings);

absl::StatusOr<RemoteTraverse> FromWire(const v1::Traverse& traverse);
absl::StatusOr<curvereg::TrajectoryPose> FromWire(const v1::TrajectoryPose& pose);
absl::StatusOr<LinkSummary> FromWire(const v1::TraverseLink& link);
absl::StatusOr<curvereg::ScanResult> FromWire(const v1::ScanResult& result);
absl::StatusOr<TraverseEvent> FromWire(const v1::WatchTraverseResponse& event);
OptimizationOutcome FromWire(const v1::OptimizeTraverseResponse& response);

// The header and the payload of a scan. Errors of wire::EncodeScan.
struct EncodedScan {
  v1::StreamedScanHeader header;
  std::string payload;
};
absl::StatusOr<EncodedScan> Encode(const StreamedScan& scan, const TransferEncoding& encoding);

}  // namespace curvereg::internal

#endif  // CURVEREG_CLIENT_TRAVERSE_CONVERSION_H_
