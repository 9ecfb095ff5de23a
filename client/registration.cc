// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/registration.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/remote_scan.h"
#include "client/retry.h"
#include "curvereg/v1/registration_service.grpc.pb.h"
#include "wire/error.h"
#include "wire/options_conversion.h"
#include "wire/result_conversion.h"

namespace curvereg::internal {
namespace {

using Clock = std::chrono::steady_clock;

// How long after the deadline an answer is still waited for.
constexpr std::chrono::seconds kAnswerGrace(2);

absl::StatusOr<v1::RegisterScansRequest> RequestOf(const ScanReference& source, const ScanReference& target,
                                                   const TransferEncoding& encoding) {
  absl::StatusOr<v1::ScanInput> source_input = ScanInputOf(source, encoding);
  if (!source_input.ok()) return wire::WithinField("source", source_input.status());
  absl::StatusOr<v1::ScanInput> target_input = ScanInputOf(target, encoding);
  if (!target_input.ok()) return wire::WithinField("target", target_input.status());
  v1::RegisterScansRequest request;
  *request.mutable_source() = *std::move(source_input);
  *request.mutable_target() = *std::move(target_input);
  return request;
}

// A server's clock is another one, so the deadline travels as what is left of it.
v1::RegistrationOptions OptionsAt(Clock::time_point now, RegistrationOptions options) {
  if (options.deadline) {
    const double left = std::chrono::duration<double>(std::max(*options.deadline, now) - now).count();
    // Past the deadline a little is left, for a budget of 0 is refused: the answer is then what there is at once.
    const double usable = std::max(left, 1e-9);
    options.time_budget_s = std::min(options.time_budget_s.value_or(usable), usable);
  }
  return wire::ToWire(options);
}

// The time after which an answer is of no use. None: no deadline.
std::optional<Clock::time_point> LatestAnswer(const RegistrationOptions& options, Clock::duration call_timeout) {
  if (!options.deadline) return std::nullopt;
  const Clock::time_point now = Clock::now();
  return std::clamp(*options.deadline, now, now + call_timeout) + kAnswerGrace;
}

RegistrationResult OutOfTime(const RegistrationOptions& options) {
  RegistrationResult result;
  result.verdict.reasons = {Reason::kDeadline};
  result.seed = options.seed;
  return result;
}

}  // namespace

absl::StatusOr<RegistrationResult> RegisterScans(Connection& connection, const ScanReference& source,
                                                 const ScanReference& target, const RegistrationOptions& options,
                                                 const TransferEncoding& encoding) {
  const Stop stop{options.cancellation, LatestAnswer(options, connection.options().call_timeout)};
  absl::StatusOr<v1::RegisterScansRequest> request = RequestOf(source, target, encoding);
  if (!request.ok()) return request.status();
  v1::RegisterScansResponse response;
  const absl::Status status = CallUnary(
      connection,
      [&](const auto& channel, grpc::ClientContext* context) {
        *request->mutable_options() = OptionsAt(Clock::now(), options);
        return v1::RegistrationService::NewStub(channel)->RegisterScans(context, *request, &response);
      },
      stop);
  // The server had no turn for it in time, or its answer is late.
  if (absl::IsDeadlineExceeded(status) && Stop{{}, options.deadline}.PastDeadline()) return OutOfTime(options);
  if (!status.ok()) return status;
  if (!response.has_result()) return absl::InternalError("the server answered a registration without a result");
  absl::StatusOr<RegistrationResult> result = wire::FromWire(response.result());
  // Not the caller's fault, as the error of the conversion would have it.
  if (!result.ok()) return absl::InternalError(absl::StrCat("the server's result: ", result.status().ToString()));
  return result;
}

}  // namespace curvereg::internal
