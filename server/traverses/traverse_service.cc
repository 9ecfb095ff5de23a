// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/traverses/traverse_service.h"

#include <utility>

#include "absl/status/statusor.h"

namespace curvereg::server {
namespace {

constexpr const char* kService = v1::TraverseService::service_full_name();
constexpr MethodTraits kCreateTraverse = {kService, "CreateTraverse", Scope::kWrite};
constexpr MethodTraits kStreamScans = {kService, "StreamScans", Scope::kWrite};
constexpr MethodTraits kGetTraverse = {kService, "GetTraverse", Scope::kRead};
constexpr MethodTraits kListTraverses = {kService, "ListTraverses", Scope::kRead};
constexpr MethodTraits kGetTrajectory = {kService, "GetTrajectory", Scope::kRead};
constexpr MethodTraits kOptimizeTraverse = {kService, "OptimizeTraverse", Scope::kWrite};
constexpr MethodTraits kDeleteTraverse = {kService, "DeleteTraverse", Scope::kWrite};

template <typename Answer>
absl::Status Fill(absl::StatusOr<Answer> answer, Answer& response) {
  if (answer.ok()) response = *std::move(answer);
  return answer.status();
}

// Waits in the traverse's own queue, then in that of the worker pool. Finish is called by whoever has the end; nobody
// touches the object after that but gRPC.
class OptimizeCall final : public grpc::ServerUnaryReactor {
 public:
  OptimizeCall(const CallEnvironment& calls, grpc::CallbackServerContext& context)
      : call_(calls, kOptimizeTraverse, context) {}

  // Request and response are gRPC's, which keeps them until OnDone.
  grpc::ServerUnaryReactor* Start(Traverses& traverses, const v1::OptimizeTraverseRequest& request,
                                  v1::OptimizeTraverseResponse& response) {
    grpc::ServerUnaryReactor* const reactor = this;
    call_.CountReceived();
    if (!call_.admitted().ok()) {
      End(call_.admitted());
      return reactor;
    }
    const absl::StatusOr<std::shared_ptr<TrackedTraverse>> traverse = traverses.Find(request.name());
    if (!traverse.ok()) {
      End(traverse.status());
      return reactor;
    }
    (*traverse)->Optimize(request, call_.client(), call_.stop(),
                          [this, &response](absl::StatusOr<v1::OptimizeTraverseResponse> answer) {
                            End(Fill(std::move(answer), response));
                          });
    return reactor;
  }

  void OnCancel() override { call_.Cancel(); }
  void OnDone() override { delete this; }

 private:
  ~OptimizeCall() override = default;

  void End(const absl::Status& status) {
    if (status.ok()) call_.CountSent();
    Finish(call_.Finish(status));
  }

  Call call_;
};

}  // namespace

TraverseService::TraverseService(const TraverseBackend& backend)
    : backend_(backend),
      scan_streams_{
          backend.calls,
          {{backend.scans.limits, backend.scans.memory, backend.scans.store, backend.calls.metrics, &upload_owners_},
           backend.traverses},
          backend.disk_pool},
      watch_streams_{backend.calls, backend.traverses, backend.disk_pool},
      map_streams_{backend.calls, backend.scans.limits, backend.traverses,
                   backend.maps,  backend.pool,         backend.disk_pool} {
  Check(backend.calls, kCreateTraverse, &TraverseService::CreateTraverse);
  Check(backend.calls, kGetTraverse, &TraverseService::GetTraverse);
  Check(backend.calls, kListTraverses, &TraverseService::ListTraverses);
  Check(backend.calls, kGetTrajectory, &TraverseService::GetTrajectory);
  Check(backend.calls, WatchStream::kTraits, &TraverseService::WatchTraverse);
  Check(backend.calls, MapStream::kTraits, &TraverseService::DownloadMap);
  Check(backend.calls, kOptimizeTraverse, &TraverseService::OptimizeTraverse);
  Check(backend.calls, kDeleteTraverse, &TraverseService::DeleteTraverse);
}

UnaryDiskCall* TraverseService::NewCall(const MethodTraits& traits, grpc::CallbackServerContext& context) const {
  return new UnaryDiskCall(*backend_.disk_pool, backend_.calls, traits, context);
}

grpc::ServerUnaryReactor* TraverseService::CreateTraverse(grpc::CallbackServerContext* context,
                                                          const v1::CreateTraverseRequest* request,
                                                          v1::CreateTraverseResponse* response) {
  return NewCall(kCreateTraverse, *context)->Start([this, request, response] {
    return Fill(backend_.traverses->Create(*request), *response->mutable_traverse());
  });
}

grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* TraverseService::StreamScans(
    grpc::CallbackServerContext* context) {
  return new ChunkStream<ScanStreamSession>(scan_streams_, kStreamScans, *context);
}

grpc::ServerUnaryReactor* TraverseService::GetTraverse(grpc::CallbackServerContext* context,
                                                       const v1::GetTraverseRequest* request,
                                                       v1::GetTraverseResponse* response) {
  return NewCall(kGetTraverse, *context)->Start([this, request, response] {
    const absl::StatusOr<std::shared_ptr<TrackedTraverse>> traverse = backend_.traverses->Find(request->name());
    if (traverse.ok()) *response->mutable_traverse() = (*traverse)->Description();
    return traverse.status();
  });
}

grpc::ServerUnaryReactor* TraverseService::ListTraverses(grpc::CallbackServerContext* context,
                                                         const v1::ListTraversesRequest* request,
                                                         v1::ListTraversesResponse* response) {
  return NewCall(kListTraverses, *context)->Start([this, request, response] {
    return Fill(backend_.traverses->List(*request), *response);
  });
}

grpc::ServerUnaryReactor* TraverseService::GetTrajectory(grpc::CallbackServerContext* context,
                                                         const v1::GetTrajectoryRequest* request,
                                                         v1::GetTrajectoryResponse* response) {
  return NewCall(kGetTrajectory, *context)->Start([this, request, response] {
    const absl::StatusOr<std::shared_ptr<TrackedTraverse>> traverse = backend_.traverses->Find(request->name());
    if (!traverse.ok()) return traverse.status();
    return Fill((*traverse)->Trajectory(request->page_size(), request->page_token()), *response);
  });
}

grpc::ServerWriteReactor<v1::WatchTraverseResponse>* TraverseService::WatchTraverse(
    grpc::CallbackServerContext* context, const v1::WatchTraverseRequest* request) {
  return new WatchStream(watch_streams_, *context, *request);
}

grpc::ServerWriteReactor<v1::DownloadMapResponse>* TraverseService::DownloadMap(grpc::CallbackServerContext* context,
                                                                                const v1::DownloadMapRequest* request) {
  return new MapStream(map_streams_, *context, *request);
}

grpc::ServerUnaryReactor* TraverseService::OptimizeTraverse(grpc::CallbackServerContext* context,
                                                            const v1::OptimizeTraverseRequest* request,
                                                            v1::OptimizeTraverseResponse* response) {
  return (new OptimizeCall(backend_.calls, *context))->Start(*backend_.traverses, *request, *response);
}

grpc::ServerUnaryReactor* TraverseService::DeleteTraverse(grpc::CallbackServerContext* context,
                                                          const v1::DeleteTraverseRequest* request,
                                                          v1::DeleteTraverseResponse*) {
  return NewCall(kDeleteTraverse, *context)->Start([this, request] {
    const absl::Status deleted = backend_.traverses->Delete(request->name());
    if (deleted.ok()) backend_.maps->Forget(request->name());
    return deleted;
  });
}

}  // namespace curvereg::server
