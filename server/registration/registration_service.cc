// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/registration/registration_service.h"

#include "server/registration/method_list.h"
#include "server/registration/register_call.h"
#include "server/registration/render_call.h"

namespace curvereg::server {
namespace {

constexpr MethodTraits kListMethods = {v1::RegistrationService::service_full_name(), "ListMethods", Scope::kRead};

// From counts that are kept; asks no disk.
v1::ServerLoad LoadOf(const RegistrationBackend& backend) {
  v1::ServerLoad load;
  const WorkerPoolStatistics pool = backend.pool->Statistics();
  load.set_registrations_running(static_cast<uint32_t>(pool.num_running));
  load.set_registrations_waiting(static_cast<uint32_t>(pool.num_waiting));
  load.set_memory_reserved_bytes(backend.scans.memory->reserved_bytes());
  load.set_cache_bytes(backend.scans.cache->GetStatistics().bytes);
  if (backend.scans.store == nullptr) return load;
  const StoreStatistics store = backend.scans.store->Statistics();
  load.set_stored_bytes(store.stored_bytes);
  load.set_scans(store.num_scans);
  load.set_uploads(store.num_uploads);
  return load;
}

}  // namespace

RegistrationService::RegistrationService(const RegistrationBackend& backend) : backend_(backend) {
  Check(backend.calls, RegisterCall::kTraits, &RegistrationService::RegisterScans);
  Check(backend.calls, kListMethods, &RegistrationService::ListMethods);
  Check(backend.calls, RenderCall::kTraits, &RegistrationService::RenderScan);
}

grpc::ServerUnaryReactor* RegistrationService::RegisterScans(grpc::CallbackServerContext* context,
                                                             const v1::RegisterScansRequest* request,
                                                             v1::RegisterScansResponse* response) {
  return (new RegisterCall(backend_, *context, *request, *response))->Start();
}

grpc::ServerUnaryReactor* RegistrationService::ListMethods(grpc::CallbackServerContext* context,
                                                           const v1::ListMethodsRequest*,
                                                           v1::ListMethodsResponse* response) {
  Call call(backend_.calls, kListMethods, *context);
  call.CountReceived();
  if (call.admitted().ok()) {
    *response = DescribeMethods(backend_.scans.limits);
    *response->mutable_load() = LoadOf(backend_);
    call.CountSent();
  }
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  reactor->Finish(call.Finish(call.admitted()));
  return reactor;
}

grpc::ServerUnaryReactor* RegistrationService::RenderScan(grpc::CallbackServerContext* context,
                                                          const v1::RenderScanRequest* request,
                                                          v1::RenderScanResponse* response) {
  return (new RenderCall(backend_, *context, *request, *response))->Start();
}

}  // namespace curvereg::server
