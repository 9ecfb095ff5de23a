// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Errors with a reason from the registry (proto/curvereg/v1/error_reason.proto). Inside a program they travel as
// absl::Status with the google.rpc details as payloads; status_mapping.h turns them to and from grpc::Status.
#ifndef CURVEREG_WIRE_ERROR_H_
#define CURVEREG_WIRE_ERROR_H_

#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "curvereg/v1/error_reason.pb.h"
#include "google/rpc/error_details.pb.h"

namespace curvereg::wire {

inline constexpr char kErrorDomain[] = "curvereg";

// "QUEUE_FULL" for ERROR_REASON_QUEUE_FULL.
std::string ReasonName(v1::ErrorReason reason);
std::optional<v1::ErrorReason> ReasonFromName(std::string_view name);

// The status code that the registry gives the reason; kInternal for reasons that are never sent.
absl::StatusCode ReasonCode(v1::ErrorReason reason);

// A status with the reason's code and exactly one ErrorInfo. `metadata` goes into it.
absl::Status MakeError(v1::ErrorReason reason, std::string_view message,
                       const std::map<std::string, std::string>& metadata = {});

// INVALID_FIELD with a BadRequest that names the field, e.g. "source.inline_scan.header.layout".
absl::Status FieldError(std::string_view field, std::string_view description);

// The same INVALID_FIELD error with "prefix." before each field that it names; other errors unchanged.
absl::Status WithinField(std::string_view prefix, absl::Status status);

// The same error with a RetryInfo.
absl::Status WithRetryDelay(absl::Status status, std::chrono::milliseconds delay);

// What an error carries; empty where it carries none.
std::optional<google::rpc::ErrorInfo> ErrorInfoOf(const absl::Status& status);
std::optional<v1::ErrorReason> ReasonOf(const absl::Status& status);
std::optional<google::rpc::BadRequest> BadRequestOf(const absl::Status& status);
std::optional<std::chrono::milliseconds> RetryDelayOf(const absl::Status& status);

}  // namespace curvereg::wire

#endif  // CURVEREG_WIRE_ERROR_H_
