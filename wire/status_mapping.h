// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The one place where statuses cross the wire: absl::Status with details <-> grpc::Status with a google.rpc.Status.
#ifndef CURVEREG_WIRE_STATUS_MAPPING_H_
#define CURVEREG_WIRE_STATUS_MAPPING_H_

#include <grpcpp/support/status.h>

#include <string_view>

#include "absl/status/status.h"

namespace curvereg::wire {

// For the caller: exactly one ErrorInfo (one is made from the code where the error carries none: INVALID_ARGUMENT of
// the core is UNUSABLE_SCAN, CANCELLED and DEADLINE_EXCEEDED are themselves, the rest INTERNAL), the other details, and
// a RequestInfo with the request id unless that is empty. Messages are cut to 1 KiB; those of INTERNAL errors are
// replaced by a general one, for they may tell of the server's inside.
grpc::Status ToGrpcStatus(const absl::Status& status, std::string_view request_id);

// The caller's side: code, message and details as payloads. Details that do not parse are left out.
absl::Status FromGrpcStatus(const grpc::Status& status);

}  // namespace curvereg::wire

#endif  // CURVEREG_WIRE_STATUS_MAPPING_H_
