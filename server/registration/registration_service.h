// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// RegistrationService: decode -> core -> encode. Computing happens on the worker pool.
#ifndef CURVEREG_SERVER_REGISTRATION_REGISTRATION_SERVICE_H_
#define CURVEREG_SERVER_REGISTRATION_REGISTRATION_SERVICE_H_

#include "curvereg/v1/registration_service.grpc.pb.h"
#include "server/preparation/prepared_scan_cache.h"
#include "server/rpc/call.h"
#include "server/rpc/checked_service.h"
#include "server/scheduling/memory_budget.h"
#include "server/scheduling/worker_pool.h"
#include "server/settings/server_config.h"
#include "server/store/scan_store.h"

namespace curvereg::server {

// What the service works with. All outlive it; `store` may be null: then no scan has a name.
struct RegistrationBackend {
  CallEnvironment calls;
  LimitsConfig limits;  // resolved: no zeros that mean "as the machine has"
  WorkerPool* pool = nullptr;
  MemoryBudget* memory = nullptr;
  PreparedScanCache* cache = nullptr;
  ScanStore* store = nullptr;
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
