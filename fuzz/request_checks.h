// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What fuzzers of the services' messages share.
#ifndef CURVEREG_FUZZ_REQUEST_CHECKS_H_
#define CURVEREG_FUZZ_REQUEST_CHECKS_H_

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "server/settings/server_config.h"
#include "wire/error.h"
#include "wire/status_mapping.h"

namespace curvereg::server {

// Small enough that no input takes long, large enough that every limit can be met and passed.
inline LimitsConfig FuzzLimits() {
  LimitsConfig limits;
  limits.max_scan_points = 100'000;
  limits.max_scan_bytes = uint64_t{1} << 20;
  limits.max_chunk_bytes = 4096;
  return limits;
}

inline void Require(bool condition) {
  if (!condition) std::abort();
}

// Whatever came, it is the caller's fault, said with a reason, and where a field is to blame the field is named.
inline void CheckError(const absl::Status& status) {
  if (status.ok()) return;
  const std::optional<v1::ErrorReason> reason = wire::ReasonOf(status);
  Require(reason.has_value() && *reason != v1::ERROR_REASON_INTERNAL && *reason != v1::ERROR_REASON_UNSPECIFIED);
  Require(!status.message().empty() && status.code() == wire::ReasonCode(*reason));
  const auto bad_request = wire::BadRequestOf(status);
  Require((*reason == v1::ERROR_REASON_INVALID_FIELD) == bad_request.has_value());
  if (bad_request.has_value()) Require(!bad_request->field_violations(0).field().empty());
  Require(wire::ReasonOf(wire::FromGrpcStatus(wire::ToGrpcStatus(status, "id"))) == reason);
}

// The next of a row of messages, cut off its front; none: that was the last.
inline std::optional<std::string> NextText(std::string_view& bytes) {
  if (bytes.size() < 2) return std::nullopt;
  const size_t length = static_cast<uint8_t>(bytes[0]) + 256U * static_cast<uint8_t>(bytes[1]);
  std::string text(bytes.substr(2, length));
  bytes.remove_prefix(std::min(bytes.size(), 2 + length));
  return text;
}

template <typename Message, typename Check>
void Decode(std::string_view bytes, const Check& check) {
  Message message;
  if (message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) check(message);
}

}  // namespace curvereg::server

#endif  // CURVEREG_FUZZ_REQUEST_CHECKS_H_
