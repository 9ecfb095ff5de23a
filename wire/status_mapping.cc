// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/status_mapping.h"

#include <string>

#include "absl/strings/cord.h"
#include "google/rpc/status.pb.h"
#include "wire/error.h"

namespace curvereg::wire {
namespace {

constexpr std::size_t kMaxMessageBytes = 1024;

// Errors of the core carry a code and a message only.
absl::Status WithReason(const absl::Status& status) {
  if (ReasonOf(status).has_value()) return status;
  const std::string message(status.message());
  switch (status.code()) {
    case absl::StatusCode::kInvalidArgument:
      return MakeError(v1::ERROR_REASON_UNUSABLE_SCAN, message);
    case absl::StatusCode::kUnimplemented:
      return MakeError(v1::ERROR_REASON_METHOD_UNAVAILABLE, message);
    case absl::StatusCode::kCancelled:
      return MakeError(v1::ERROR_REASON_CANCELLED, message);
    case absl::StatusCode::kDeadlineExceeded:
      return MakeError(v1::ERROR_REASON_DEADLINE_EXCEEDED, message);
    default:
      return MakeError(v1::ERROR_REASON_INTERNAL, message);
  }
}

std::string ShortMessage(const absl::Status& status) {
  if (status.code() == absl::StatusCode::kInternal) return "internal error; the server's log has the request id";
  std::string message(status.message());
  if (message.size() <= kMaxMessageBytes) return message;
  std::size_t end = kMaxMessageBytes;
  while (end > 0 && (static_cast<unsigned char>(message[end]) & 0xC0U) == 0x80U) --end;  // not within a UTF-8 character
  message.resize(end);
  return message;
}

void AddDetail(google::rpc::Status& details, absl::string_view url, const absl::Cord& payload) {
  google::protobuf::Any* any = details.add_details();
  any->set_type_url(std::string(url));
  any->set_value(std::string(payload));
}

}  // namespace

grpc::Status ToGrpcStatus(const absl::Status& status, std::string_view request_id) {
  if (status.ok()) return grpc::Status::OK;
  const absl::Status with_reason = WithReason(status);
  google::rpc::Status details;
  details.set_code(static_cast<int>(with_reason.code()));
  details.set_message(ShortMessage(with_reason));
  with_reason.ForEachPayload(
      [&](absl::string_view url, const absl::Cord& payload) { AddDetail(details, url, payload); });
  if (!request_id.empty()) {
    google::rpc::RequestInfo info;
    info.set_request_id(std::string(request_id));
    details.add_details()->PackFrom(info);
  }
  return {static_cast<grpc::StatusCode>(with_reason.code()), details.message(), details.SerializeAsString()};
}

absl::Status FromGrpcStatus(const grpc::Status& status) {
  if (status.ok()) return absl::OkStatus();
  absl::Status result(static_cast<absl::StatusCode>(status.error_code()), status.error_message());
  google::rpc::Status details;
  if (!details.ParseFromString(status.error_details())) return result;
  for (const google::protobuf::Any& any : details.details()) result.SetPayload(any.type_url(), absl::Cord(any.value()));
  return result;
}

}  // namespace curvereg::wire
