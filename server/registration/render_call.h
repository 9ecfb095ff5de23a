// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// One call of RenderScan.
#ifndef CURVEREG_SERVER_REGISTRATION_RENDER_CALL_H_
#define CURVEREG_SERVER_REGISTRATION_RENDER_CALL_H_

#include <optional>
#include <set>

#include "render/scan_pictures.h"
#include "server/preparation/registration_input.h"
#include "server/registration/registration_service.h"
#include "server/rpc/computing_call.h"

namespace curvereg::server {

class RenderCall final : public ComputingCall {
 public:
  static const MethodTraits kTraits;

  // All outlive the call.
  RenderCall(const RegistrationBackend& backend, grpc::CallbackServerContext& context,
             const v1::RenderScanRequest& request, v1::RenderScanResponse& response);

 private:
  absl::StatusOr<uint64_t> Check() override;
  absl::Status Compute(const Stop& stop) override;
  void Release() override { scan_ = std::nullopt; }

  const RegistrationBackend& backend() const { return backend_; }
  absl::Status Answer(const ScanPictures& pictures, const Stop& stop);

  const RegistrationBackend& backend_;
  const v1::RenderScanRequest& request_;
  v1::RenderScanResponse& response_;
  std::set<PictureKind> kinds_;
  std::optional<RegistrationInput> scan_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_REGISTRATION_RENDER_CALL_H_
