// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/error.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

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

// Reasons that are not here are never sent.
constexpr std::array<std::pair<v1::ErrorReason, absl::StatusCode>, 32> kCodes = {
    {{v1::ERROR_REASON_INVALID_FIELD, absl::StatusCode::kInvalidArgument},
     {v1::ERROR_REASON_UNUSABLE_SCAN, absl::StatusCode::kInvalidArgument},
     {v1::ERROR_REASON_UNEXPECTED_MESSAGE, absl::StatusCode::kInvalidArgument},
     {v1::ERROR_REASON_CHECKSUM_MISMATCH, absl::StatusCode::kDataLoss},
     {v1::ERROR_REASON_DIGEST_MISMATCH, absl::StatusCode::kDataLoss},
     {v1::ERROR_REASON_MALFORMED_PAYLOAD, absl::StatusCode::kDataLoss},
     {v1::ERROR_REASON_STORED_SCAN_DAMAGED, absl::StatusCode::kDataLoss},
     {v1::ERROR_REASON_SCAN_NOT_FOUND, absl::StatusCode::kNotFound},
     {v1::ERROR_REASON_UPLOAD_NOT_FOUND, absl::StatusCode::kNotFound},
     {v1::ERROR_REASON_TRAVERSE_NOT_FOUND, absl::StatusCode::kNotFound},
     {v1::ERROR_REASON_OFFSET_OUT_OF_RANGE, absl::StatusCode::kOutOfRange},
     {v1::ERROR_REASON_SEQUENCE_OUT_OF_RANGE, absl::StatusCode::kOutOfRange},
     {v1::ERROR_REASON_WRITER_REPLACED, absl::StatusCode::kAborted},
     {v1::ERROR_REASON_UPLOAD_DIFFERS, absl::StatusCode::kFailedPrecondition},
     {v1::ERROR_REASON_SEQUENCE_DIFFERS, absl::StatusCode::kFailedPrecondition},
     {v1::ERROR_REASON_SCAN_IN_USE, absl::StatusCode::kFailedPrecondition},
     {v1::ERROR_REASON_SCAN_TOO_LARGE, absl::StatusCode::kResourceExhausted},
     {v1::ERROR_REASON_QUEUE_FULL, absl::StatusCode::kResourceExhausted},
     {v1::ERROR_REASON_CLIENT_QUOTA, absl::StatusCode::kResourceExhausted},
     {v1::ERROR_REASON_MEMORY_BUDGET, absl::StatusCode::kResourceExhausted},
     {v1::ERROR_REASON_TOO_MANY_UPLOADS, absl::StatusCode::kResourceExhausted},
     {v1::ERROR_REASON_STORAGE_FULL, absl::StatusCode::kResourceExhausted},
     {v1::ERROR_REASON_TOO_MANY_TRAVERSES, absl::StatusCode::kResourceExhausted},
     {v1::ERROR_REASON_TRAVERSE_FULL, absl::StatusCode::kResourceExhausted},
     {v1::ERROR_REASON_NOT_SERVING, absl::StatusCode::kUnavailable},
     {v1::ERROR_REASON_STORAGE_FAULT, absl::StatusCode::kUnavailable},
     {v1::ERROR_REASON_METHOD_UNAVAILABLE, absl::StatusCode::kUnimplemented},
     {v1::ERROR_REASON_DEADLINE_EXCEEDED, absl::StatusCode::kDeadlineExceeded},
     {v1::ERROR_REASON_CANCELLED, absl::StatusCode::kCancelled},
     {v1::ERROR_REASON_UNAUTHENTICATED, absl::StatusCode::kUnauthenticated},
     {v1::ERROR_REASON_SCOPE_MISSING, absl::StatusCode::kPermissionDenied},
     {v1::ERROR_REASON_TRAVERSE_EXISTS, absl::StatusCode::kAlreadyExists}}};

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
  for (const auto& [known, code] : kCodes) {
    if (known == reason) return code;
  }
  return absl::StatusCode::kInternal;
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
