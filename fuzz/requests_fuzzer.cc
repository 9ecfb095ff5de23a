// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Any bytes as any message of the services, through the decoding and validation that the server (and, of answers, the
// client) does. The first byte picks the message, the rest is what came on the wire; an upload, as a stream of scans,
// is a row of messages, each after its length in two bytes.
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

#include "curvereg/v1/registration_service.pb.h"
#include "curvereg/v1/scan_service.pb.h"
#include "fuzz/memory_scan_store.h"
#include "fuzz/request_checks.h"
#include "server/operations/metrics.h"
#include "server/registration/registration_service.h"
#include "server/registration/scan_side.h"
#include "server/scans/scan_conversion.h"
#include "server/scans/upload_message.h"
#include "server/scans/upload_session.h"
#include "server/scheduling/memory_budget.h"
#include "server/scheduling/prepared_scan_cache.h"
#include "server/store/page_token.h"
#include "wire/conversion.h"
#include "wire/digest.h"
#include "wire/error.h"
#include "wire/status_mapping.h"

namespace curvereg::server {
namespace {

void CheckInput(const v1::ScanInput& input, const std::string& field) {
  MemoryScanStore store;
  static Metrics metrics;  // dear to make
  PreparedScanCache cache(uint64_t{1} << 20);
  RegistrationBackend backend;
  backend.calls.metrics = &metrics;
  backend.limits = FuzzLimits();
  backend.cache = &cache;
  backend.store = &store;
  const absl::StatusOr<ScanSide> side = ScanSide::Find(input, field, backend);
  CheckError(side.status());
  if (const auto bad_request = wire::BadRequestOf(side.status()); bad_request.has_value()) {
    Require(bad_request->field_violations(0).field().rfind(field, 0) == 0);
  }
  if (!side.ok()) return;
  Require(side->MemoryBytes() > 0);
  const absl::StatusOr<std::shared_ptr<const Scan>> scan = side->Decode();
  CheckError(scan.status());
  if (scan.ok()) Require((*scan)->points.size() == input.inline_scan().header().point_count());
}

void CheckOptions(const v1::RegistrationOptions& message) {
  const absl::StatusOr<RegistrationOptions> options = wire::FromWire(message, 8);
  CheckError(options.status());
  if (!options.ok()) return;
  const absl::StatusOr<RegistrationOptions> again = wire::FromWire(wire::ToWire(*options), 8);
  Require(again.ok() && again->method == options->method && again->seed == options->seed &&
          again->num_threads == options->num_threads && again->time_budget_s == options->time_budget_s);
  Require(again->prior.has_value() == options->prior.has_value());
}

// Checksums that fit let the fuzzer past them, to where no mutation would get.
void Mend(v1::UploadScanRequest& request, std::string& payload) {
  if (request.has_chunk()) {
    request.mutable_chunk()->set_offset(payload.size());
    request.mutable_chunk()->set_crc32c(wire::Crc32c(request.chunk().data()));
    payload += request.chunk().data();
  } else if (request.has_finish()) {
    *request.mutable_finish()->mutable_payload_digest() = wire::DigestOf(v1::DIGEST_ALGORITHM_SHA256, payload);
  }
}

void CheckUpload(std::string_view bytes, bool mended) {
  static Metrics metrics;
  MemoryScanStore store;
  MemoryBudget memory(uint64_t{64} << 20);
  UploadOwners owners;
  const UploadEnvironment environment = {FuzzLimits(), &memory, &store, &metrics, &owners};
  UploadSession session(environment, std::stop_source());
  std::string payload;
  while (std::optional<std::string> text = NextText(bytes)) {
    v1::UploadScanRequest request;
    const bool is_request = request.ParseFromString(*text);
    if (mended && is_request) {
      Mend(request, payload);
      text = request.SerializeAsString();
    }
    // In two slices, as gRPC may cut it.
    const std::array<grpc::Slice, 2> slices = {grpc::Slice(text->substr(0, text->size() / 2)),
                                               grpc::Slice(text->substr(text->size() / 2))};
    UploadMessage message;
    Require(message.Parse(grpc::ByteBuffer(slices.data(), slices.size())) == is_request);
    if (!is_request) return;
    const absl::StatusOr<v1::UploadScanResponse> answer = session.Handle(message);
    CheckError(answer.status());
    if (!answer.ok() || answer->has_done()) break;
  }
  Require(memory.reserved_bytes() == 0);
}

void CheckResult(const v1::RegistrationResult& message) {
  const absl::StatusOr<RegistrationResult> result = wire::FromWire(message);
  CheckError(result.status());
  if (!result.ok()) return;
  Require(wire::FromWire(wire::ToWire(*result)).ok());
  Require(wire::ToSummary(*result).ByteSizeLong() <= 200);
}

void CheckMessage(uint8_t kind, std::string_view bytes) {
  switch (kind % 11) {
    case 0:
      return Decode<v1::RegisterScansRequest>(bytes, [](const auto& request) {
        CheckInput(request.source(), "source");
        CheckInput(request.target(), "target");
        CheckOptions(request.options());
      });
    case 1:
      return Decode<v1::RenderScanRequest>(bytes, [](const auto& request) { CheckInput(request.scan(), "scan"); });
    case 2:
      return CheckUpload(bytes, false);
    case 3:
      return CheckUpload(bytes, true);
    case 4:
      return Decode<v1::DownloadScanRequest>(
          bytes, [](const auto& request) { CheckError(ScanIdOf(request.name(), "name").status()); });
    case 5:
      return Decode<v1::GetUploadRequest>(
          bytes, [](const auto& request) { CheckError(UploadIdOf(request.upload(), "upload").status()); });
    case 6:
      return Decode<v1::GetScanRequest>(
          bytes, [](const auto& request) { CheckError(ScanIdOf(request.name(), "name").status()); });
    case 7:
      return Decode<v1::DeleteScanRequest>(
          bytes, [](const auto& request) { CheckError(ScanIdOf(request.name(), "name").status()); });
    case 8:
      return Decode<v1::ListScansRequest>(bytes, [](const auto& request) {
        const std::optional<int64_t> place = PlaceOfToken(request.page_token());
        if (place.has_value()) Require(TokenOfPlace(*place) == request.page_token());
      });
    case 9:
      return Decode<v1::RegistrationResult>(bytes, CheckResult);
    default:
      const absl::Status status = wire::FromGrpcStatus({grpc::StatusCode::UNAVAILABLE, "text", std::string(bytes)});
      wire::BadRequestOf(status);
      wire::RetryDelayOf(status);
      wire::ReasonOf(status);
      return;
  }
}

}  // namespace
}  // namespace curvereg::server

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  curvereg::server::CheckMessage(data[0], {reinterpret_cast<const char*>(data) + 1, size - 1});
  return 0;
}
