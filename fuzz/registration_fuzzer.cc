// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Any bytes as a request to register or to draw scans that come with it, through the decoding and validation that the
// server does. The first byte picks the message, the rest is what came on the wire.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "curvereg/v1/registration_service.pb.h"
#include "fuzz/memory_scan_store.h"
#include "fuzz/request_checks.h"
#include "server/operations/metrics.h"
#include "server/preparation/prepared_scan_cache.h"
#include "server/preparation/registration_input.h"
#include "server/registration/registration_service.h"
#include "wire/error.h"
#include "wire/options_conversion.h"

namespace curvereg::server {
namespace {

void CheckInput(const v1::ScanInput& input, const std::string& field) {
  MemoryScanStore store;
  static Metrics metrics;  // dear to make
  PreparedScanCache cache(uint64_t{1} << 20);
  const ScanSources sources = {.limits = FuzzLimits(), .cache = &cache, .store = &store, .metrics = &metrics};
  const absl::StatusOr<RegistrationInput> side = RegistrationInput::Find(input, field, sources);
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

void CheckMessage(uint8_t kind, std::string_view bytes) {
  if (kind % 2 == 1) {
    return Decode<v1::RenderScanRequest>(bytes, [](const auto& request) { CheckInput(request.scan(), "scan"); });
  }
  Decode<v1::RegisterScansRequest>(bytes, [](const auto& request) {
    CheckInput(request.source(), "source");
    CheckInput(request.target(), "target");
    CheckOptions(request.options());
  });
}

}  // namespace
}  // namespace curvereg::server

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  curvereg::server::CheckMessage(data[0], {reinterpret_cast<const char*>(data) + 1, size - 1});
  return 0;
}
