// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// RegistrationService: decode -> core -> encode. Computing happens on the worker pool.
#ifndef CURVEREG_SERVER_REGISTRATION_REGISTRATION_SERVICE_H_
#define CURVEREG_SERVER_REGISTRATION_REGISTRATION_SERVICE_H_

#include "curvereg/v1/registration_service.grpc.pb.h"
#include "server/preparation/scan_sources.h"
#include "server/rpc/call.h"
#include "server/rpc/checked_service.h"
#include "server/scheduling/worker_pool.h"

namespace curvereg::server {

// What the service works with. All outlive it.
struct RegistrationBackend {
  CallEnvironment calls;
  ScanSources scans;
  WorkerPool* pool = nullptr;
};

class RegistrationService final : public CheckedService<v1::RegistrationService::CallbackService> {
 public:
  explicit RegistrationService(const RegistrationBackend& backend);

  grpc::ServerUnaryReactor* RegisterScans(grpc::CallbackServerContext* context, const v1::RegisterScansRequest* request,
                                          v1::RegisterScansResponse* response) override;
  grpc::ServerUnaryReactor* ListMethods(grpc::CallbackServerContext* context, const v1::ListMethodsRequest* request,
                                        v1::ListMethodsResponse* response) override;
  grpc::ServerUnaryReactor* RenderScan(grpc::CallbackServerContext* context, const v1::RenderScanRequest* request,
                                       v1::RenderScanResponse* response) override;

 private:
  const RegistrationBackend backend_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_REGISTRATION_REGISTRATION_SERVICE_H_
