// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/registration/register_call.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/methods/registration_names.h"
#include "core/register_scans.h"
#include "wire/error.h"
#include "wire/options_conversion.h"
#include "wire/result_conversion.h"

namespace curvereg::server {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kMinMargin{50};
constexpr std::chrono::milliseconds kMaxMargin{1000};

bool NeedsPreparation(Method method) { return method == Method::kCurvelet || method == Method::kIcp; }

}  // namespace

const MethodTraits RegisterCall::kTraits = {v1::RegistrationService::service_full_name(), "RegisterScans",
                                            Scope::kRead};

Clock::time_point AnswerBy(Clock::time_point now, Clock::time_point deadline) {
  return deadline - std::clamp<Clock::duration>((deadline - now) / 10, kMinMargin, kMaxMargin);
}

RegisterCall::RegisterCall(const RegistrationBackend& backend, grpc::CallbackServerContext& context,
                           const v1::RegisterScansRequest& request, v1::RegisterScansResponse& response)
    : ComputingCall({backend.calls, *backend.scans.memory, *backend.pool}, kTraits, context),
      backend_(backend),
      request_(request),
      response_(response) {}

absl::StatusOr<uint64_t> RegisterCall::Check() {
  absl::StatusOr<RegistrationOptions> options =
      wire::FromWire(request_.options(), backend().scans.limits.max_threads_per_registration);
  if (!options.ok()) return wire::WithinField("options", options.status());
  options_ = *std::move(options);
  if (!v1::ResultView_IsValid(request_.view())) return wire::FieldError("view", "not a view that this server knows");
  if (!IsAvailable(options_.method)) {
    return wire::MakeError(v1::ERROR_REASON_METHOD_UNAVAILABLE,
                           absl::StrCat("this build leaves out ", std::string(MethodName(options_.method))));
  }
  absl::StatusOr<RegistrationInput> source = RegistrationInput::Find(request_.source(), "source", backend().scans);
  if (!source.ok()) return source.status();
  absl::StatusOr<RegistrationInput> target = RegistrationInput::Find(request_.target(), "target", backend().scans);
  if (!target.ok()) return target.status();
  source_ = *std::move(source);
  target_ = *std::move(target);
  return source_->MemoryBytes() + target_->MemoryBytes();
}

absl::Status RegisterCall::Compute(const Stop& stop) {
  const Clock::time_point now = Clock::now();
  options_.cancellation = stop.cancellation;
  if (stop.deadline.has_value()) options_.deadline = AnswerBy(now, *stop.deadline);
  options_.deadline = StopOf(options_, now).deadline;  // decoding and preparing count in the time budget, too
  const absl::StatusOr<RegistrationResult> result = Register();
  if (!result.ok()) return result.status();
  backend().scans.metrics->Registered(*result);
  if (request_.view() == v1::RESULT_VIEW_SUMMARY) {
    *response_.mutable_summary() = wire::ToSummary(*result);
  } else {
    *response_.mutable_result() = wire::ToWire(*result);
  }
  return absl::OkStatus();
}

absl::StatusOr<RegistrationResult> RegisterCall::Register() const {
  // Nothing to keep of inline scans: the core prepares both at once.
  if (!NeedsPreparation(options_.method) || (!source_->is_stored() && !target_->is_stored())) return RegisterDecoded();
  return RegisterPrepared();
}

absl::StatusOr<RegistrationResult> RegisterCall::RegisterDecoded() const {
  const absl::StatusOr<std::shared_ptr<const Scan>> source = source_->Decode();
  if (!source.ok()) return source.status();
  const absl::StatusOr<std::shared_ptr<const Scan>> target = target_->Decode();
  if (!target.ok()) return target.status();
  absl::StatusOr<RegistrationResult> result = RegisterScans(**source, **target, options_);
  if (!absl::IsInvalidArgument(result.status())) return result;
  // The core does not tell which of the two it was.
  const absl::Status of_source = ValidateScan(**source, options_.limits);
  return of_source.ok() ? target_->Named(result.status()) : source_->Named(of_source);
}

absl::StatusOr<RegistrationResult> RegisterCall::RegisterPrepared() const {
  absl::StatusOr<RegistrationResult> result =
      PrepareAndRegister([&](const Stop& stop) { return source_->Prepare(stop); },
                         [&](const Stop& stop) { return target_->Prepare(stop); }, options_);
  source_->UpdateCache();
  target_->UpdateCache();
  return result;
}

}  // namespace curvereg::server
