// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/error.h"

#include <algorithm>
#include <cstdint>

#include "absl/strings/cord.h"
#include "absl/strings/str_cat.h"

namespace curvereg::wire {
namespace {

constexpr std::string_view kPrefix = "ERROR_REASON_";

// The names that google.protobuf.Any gives the details, too: a payload is a detail.
template <typename Detail>
std::string TypeUrl() {
  return absl::StrCat("type.googleapis.com/", Detail::descriptor()->full_name());
}

template <typename Detail>
void SetDetail(absl::Status& status, const Detail& detail) {
  status.SetPayload(TypeUrl<Detail>(), absl::Cord(detail.SerializeAsString()));
}

template <typename Detail>
std::optional<Detail> DetailOf(const absl::Status& status) {
  const auto payload = status.GetPayload(TypeUrl<Detail>());
  Detail detail;
  if (!payload.has_value() || !detail.ParseFromString(std::string(*payload))) return std::nullopt;
  return detail;
}

}  // namespace

std::string ReasonName(v1::ErrorReason reason) {
  const std::string& name = v1::ErrorReason_Name(reason);
  return name.size() > kPrefix.size() ? name.substr(kPrefix.size()) : std::string("UNSPECIFIED");
}

std::optional<v1::ErrorReason> ReasonFromName(std::string_view name) {
  v1::ErrorReason reason;
  if (!v1::ErrorReason_Parse(absl::StrCat(std::string(kPrefix), std::string(name)), &reason)) return std::nullopt;
  return reason;
}

absl::StatusCode ReasonCode(v1::ErrorReason reason) {
  switch (reason) {
    case v1::ERROR_REASON_INVALID_FIELD:
    case v1::ERROR_REASON_UNUSABLE_SCAN:
    case v1::ERROR_REASON_UNEXPECTED_MESSAGE:
      return absl::StatusCode::kInvalidArgument;
    case v1::ERROR_REASON_CHECKSUM_MISMATCH:
    case v1::ERROR_REASON_DIGEST_MISMATCH:
    case v1::ERROR_REASON_MALFORMED_PAYLOAD:
    case v1::ERROR_REASON_STORED_SCAN_DAMAGED:
      return absl::StatusCode::kDataLoss;
    case v1::ERROR_REASON_SCAN_NOT_FOUND:
    case v1::ERROR_REASON_UPLOAD_NOT_FOUND:
    case v1::ERROR_REASON_TRAVERSE_NOT_FOUND:
      return absl::StatusCode::kNotFound;
    case v1::ERROR_REASON_OFFSET_OUT_OF_RANGE:
    case v1::ERROR_REASON_SEQUENCE_OUT_OF_RANGE:
      return absl::StatusCode::kOutOfRange;
    case v1::ERROR_REASON_WRITER_REPLACED:
      return absl::StatusCode::kAborted;
    case v1::ERROR_REASON_UPLOAD_DIFFERS:
    case v1::ERROR_REASON_SEQUENCE_DIFFERS:
    case v1::ERROR_REASON_SCAN_IN_USE:
      return absl::StatusCode::kFailedPrecondition;
    case v1::ERROR_REASON_SCAN_TOO_LARGE:
    case v1::ERROR_REASON_QUEUE_FULL:
    case v1::ERROR_REASON_CLIENT_QUOTA:
    case v1::ERROR_REASON_MEMORY_BUDGET:
    case v1::ERROR_REASON_TOO_MANY_UPLOADS:
    case v1::ERROR_REASON_STORAGE_FULL:
    case v1::ERROR_REASON_TOO_MANY_TRAVERSES:
    case v1::ERROR_REASON_TRAVERSE_FULL:
      return absl::StatusCode::kResourceExhausted;
    case v1::ERROR_REASON_NOT_SERVING:
    case v1::ERROR_REASON_STORAGE_FAULT:
      return absl::StatusCode::kUnavailable;
    case v1::ERROR_REASON_METHOD_UNAVAILABLE:
      return absl::StatusCode::kUnimplemented;
    case v1::ERROR_REASON_DEADLINE_EXCEEDED:
      return absl::StatusCode::kDeadlineExceeded;
    case v1::ERROR_REASON_CANCELLED:
      return absl::StatusCode::kCancelled;
    case v1::ERROR_REASON_UNAUTHENTICATED:
      return absl::StatusCode::kUnauthenticated;
    case v1::ERROR_REASON_SCOPE_MISSING:
      return absl::StatusCode::kPermissionDenied;
    case v1::ERROR_REASON_TRAVERSE_EXISTS:
      return absl::StatusCode::kAlreadyExists;
    default:
      return absl::StatusCode::kInternal;
  }
}

absl::Status MakeError(v1::ErrorReason reason, std::string_view message,
                       const std::map<std::string, std::string>& metadata) {
  google::rpc::ErrorInfo info;
  info.set_reason(ReasonName(reason));
  info.set_domain(kErrorDomain);
  info.mutable_metadata()->insert(metadata.begin(), metadata.end());
  absl::Status status(ReasonCode(reason), std::string(message));
  SetDetail(status, info);
  return status;
}

absl::Status FieldError(std::string_view field, std::string_view description) {
  absl::Status status =
      MakeError(v1::ERROR_REASON_INVALID_FIELD, absl::StrCat(std::string(field), ": ", std::string(description)));
  google::rpc::BadRequest bad_request;
  google::rpc::BadRequest::FieldViolation* violation = bad_request.add_field_violations();
  violation->set_field(std::string(field));
  violation->set_description(std::string(description));
  SetDetail(status, bad_request);
  return status;
}

absl::Status WithinField(std::string_view prefix, absl::Status status) {
  std::optional<google::rpc::BadRequest> bad_request = BadRequestOf(status);
  if (!bad_request.has_value()) return status;
  for (google::rpc::BadRequest::FieldViolation& violation : *bad_request->mutable_field_violations()) {
    violation.set_field(absl::StrCat(std::string(prefix), ".", violation.field()));
  }
  absl::Status within(status.code(), absl::StrCat(std::string(prefix), ".", status.message()));
  status.ForEachPayload([&](absl::string_view url, const absl::Cord& payload) { within.SetPayload(url, payload); });
  SetDetail(within, *bad_request);
  return within;
}

absl::Status WithRetryDelay(absl::Status status, std::chrono::milliseconds delay) {
  google::rpc::RetryInfo info;
  info.mutable_retry_delay()->set_seconds(delay.count() / 1000);
  info.mutable_retry_delay()->set_nanos(static_cast<int32_t>(delay.count() % 1000) * 1'000'000);
  SetDetail(status, info);
  return status;
}

std::optional<google::rpc::ErrorInfo> ErrorInfoOf(const absl::Status& status) {
  return DetailOf<google::rpc::ErrorInfo>(status);
}

std::optional<v1::ErrorReason> ReasonOf(const absl::Status& status) {
  const std::optional<google::rpc::ErrorInfo> info = ErrorInfoOf(status);
  if (!info.has_value() || info->domain() != kErrorDomain) return std::nullopt;
  return ReasonFromName(info->reason());
}

std::optional<google::rpc::BadRequest> BadRequestOf(const absl::Status& status) {
  return DetailOf<google::rpc::BadRequest>(status);
}

std::optional<std::chrono::milliseconds> RetryDelayOf(const absl::Status& status) {
  const auto info = DetailOf<google::rpc::RetryInfo>(status);
  if (!info.has_value()) return std::nullopt;
  // Bounded, for it is the other side that says it: nobody waits longer than a day, or less than nothing.
  constexpr int64_t kMaxSeconds = 24 * 3600;
  const int64_t seconds = std::clamp<int64_t>(info->retry_delay().seconds(), 0, kMaxSeconds);
  const int32_t nanos = std::clamp(info->retry_delay().nanos(), 0, 999'999'999);
  return std::chrono::milliseconds(seconds * 1000 + nanos / 1'000'000);
}

}  // namespace curvereg::wire
