// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// One call of RegisterScans.
#ifndef CURVEREG_SERVER_REGISTRATION_REGISTER_CALL_H_
#define CURVEREG_SERVER_REGISTRATION_REGISTER_CALL_H_

#include <chrono>
#include <optional>

#include "core/methods/registration_options.h"
#include "core/methods/registration_result.h"
#include "server/preparation/registration_input.h"
#include "server/registration/registration_service.h"
#include "server/rpc/computing_call.h"

namespace curvereg::server {

// When to be done so that the answer is back before the deadline: a tenth of what remains before it, at least 50 ms and
// at most a second. The server learns the time that remains, not what the way took or will take.
std::chrono::steady_clock::time_point AnswerBy(std::chrono::steady_clock::time_point now,
                                               std::chrono::steady_clock::time_point deadline);

class RegisterCall final : public ComputingCall {
 public:
  static const MethodTraits kTraits;

  // All outlive the call.
  RegisterCall(const RegistrationBackend& backend, grpc::CallbackServerContext& context,
               const v1::RegisterScansRequest& request, v1::RegisterScansResponse& response);

 private:
  absl::StatusOr<uint64_t> Check() override;
  absl::Status Compute(const Stop& stop) override;
  void Release() override { source_ = target_ = std::nullopt; }

  const RegistrationBackend& backend() const { return backend_; }
  absl::StatusOr<RegistrationResult> Register() const;
  absl::StatusOr<RegistrationResult> RegisterDecoded() const;
  absl::StatusOr<RegistrationResult> RegisterPrepared() const;

  const RegistrationBackend& backend_;
  const v1::RegisterScansRequest& request_;
  v1::RegisterScansResponse& response_;
  RegistrationOptions options_;
  std::optional<RegistrationInput> source_;
  std::optional<RegistrationInput> target_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_REGISTRATION_REGISTER_CALL_H_
