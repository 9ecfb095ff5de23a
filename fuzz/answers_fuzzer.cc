// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Any bytes as what a server answers, through the decoding and validation that the client does. The first byte picks
// the message, the rest is what came on the wire.
#include <cstdint>
#include <string>
#include <string_view>

#include "client/traverse_conversion.h"
#include "curvereg/v1/registration_service.pb.h"
#include "curvereg/v1/traverse_service.pb.h"
#include "fuzz/request_checks.h"
#include "wire/error.h"
#include "wire/result_conversion.h"
#include "wire/status_mapping.h"
#include "wire/trajectory_conversion.h"

namespace curvereg::server {
namespace {

void CheckResult(const v1::RegistrationResult& message) {
  const absl::StatusOr<RegistrationResult> result = wire::FromWire(message);
  CheckError(result.status());
  if (!result.ok()) return;
  Require(wire::FromWire(wire::ToWire(*result)).ok());
  Require(wire::ToSummary(*result).ByteSizeLong() <= 200);
}

void CheckStatus(std::string_view details) {
  const absl::Status status = wire::FromGrpcStatus({grpc::StatusCode::UNAVAILABLE, "text", std::string(details)});
  Require(!status.ok());
  wire::BadRequestOf(status);
  wire::RetryDelayOf(status);
  wire::ReasonOf(status);
}

// What makes no sense is the server's fault, not the caller's.
void CheckTraverseAnswer(const absl::Status& status) {
  Require(status.ok() || (absl::IsInternal(status) && !status.message().empty()));
}

void CheckMessage(uint8_t kind, std::string_view bytes) {
  switch (kind % 6) {
    case 0:
      return Decode<v1::RegistrationResult>(bytes, CheckResult);
    case 1:
      return CheckStatus(bytes);
    case 2:
      return Decode<v1::TrajectoryPose>(bytes, [](const auto& pose) { CheckError(wire::FromWire(pose).status()); });
    case 3:
      return Decode<v1::WatchTraverseResponse>(
          bytes, [](const auto& event) { CheckTraverseAnswer(internal::FromWire(event).status()); });
    case 4:
      return Decode<v1::Traverse>(
          bytes, [](const auto& traverse) { CheckTraverseAnswer(internal::FromWire(traverse).status()); });
    default:
      return Decode<v1::OptimizeTraverseResponse>(bytes, [](const auto& response) { internal::FromWire(response); });
  }
}

}  // namespace
}  // namespace curvereg::server

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  curvereg::server::CheckMessage(data[0], {reinterpret_cast<const char*>(data) + 1, size - 1});
  return 0;
}
