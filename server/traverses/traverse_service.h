// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// TraverseService: the traverses over the wire. Disk work happens on the disk pool, registrations and maps on the
// other.
#ifndef CURVEREG_SERVER_TRAVERSES_TRAVERSE_SERVICE_H_
#define CURVEREG_SERVER_TRAVERSES_TRAVERSE_SERVICE_H_

#include "curvereg/v1/traverse_service.grpc.pb.h"
#include "server/maps/map_builder.h"
#include "server/preparation/scan_sources.h"
#include "server/rpc/call.h"
#include "server/rpc/checked_service.h"
#include "server/rpc/chunk_stream.h"
#include "server/rpc/unary_disk_call.h"
#include "server/scans/upload_owners.h"
#include "server/scheduling/worker_pool.h"
#include "server/traverses/map_stream.h"
#include "server/traverses/scan_stream_session.h"
#include "server/traverses/traverses.h"
#include "server/traverses/watch_stream.h"

namespace curvereg::server {

// What the service works with. All outlive it.
struct TraverseBackend {
  CallEnvironment calls;
  ScanSources scans;
  WorkerPool* pool = nullptr;       // registrations and maps
  WorkerPool* disk_pool = nullptr;  // reading and decoding
  Traverses* traverses = nullptr;
  MapBuilder* maps = nullptr;
};

// As protobuf's CallbackService, but for the raw messages of StreamScans.
using TraverseServiceBase = v1::TraverseService::WithRawCallbackMethod_StreamScans<
    v1::TraverseService::WithCallbackMethod_CreateTraverse<v1::TraverseService::WithCallbackMethod_GetTraverse<
        v1::TraverseService::WithCallbackMethod_ListTraverses<v1::TraverseService::WithCallbackMethod_GetTrajectory<
            v1::TraverseService::WithCallbackMethod_WatchTraverse<v1::TraverseService::WithCallbackMethod_DownloadMap<
                v1::TraverseService::WithCallbackMethod_OptimizeTraverse<
                    v1::TraverseService::WithCallbackMethod_DeleteTraverse<v1::TraverseService::Service>>>>>>>>>;

class TraverseService final : public CheckedService<TraverseServiceBase> {
 public:
  explicit TraverseService(const TraverseBackend& backend);

  grpc::ServerUnaryReactor* CreateTraverse(grpc::CallbackServerContext* context,
                                           const v1::CreateTraverseRequest* request,
                                           v1::CreateTraverseResponse* response) override;
  grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* StreamScans(
      grpc::CallbackServerContext* context) override;
  grpc::ServerUnaryReactor* GetTraverse(grpc::CallbackServerContext* context, const v1::GetTraverseRequest* request,
                                        v1::GetTraverseResponse* response) override;
  grpc::ServerUnaryReactor* ListTraverses(grpc::CallbackServerContext* context, const v1::ListTraversesRequest* request,
                                          v1::ListTraversesResponse* response) override;
  grpc::ServerUnaryReactor* GetTrajectory(grpc::CallbackServerContext* context, const v1::GetTrajectoryRequest* request,
                                          v1::GetTrajectoryResponse* response) override;
  grpc::ServerWriteReactor<v1::WatchTraverseResponse>* WatchTraverse(grpc::CallbackServerContext* context,
                                                                     const v1::WatchTraverseRequest* request) override;
  grpc::ServerWriteReactor<v1::DownloadMapResponse>* DownloadMap(grpc::CallbackServerContext* context,
                                                                 const v1::DownloadMapRequest* request) override;
  grpc::ServerUnaryReactor* OptimizeTraverse(grpc::CallbackServerContext* context,
                                             const v1::OptimizeTraverseRequest* request,
                                             v1::OptimizeTraverseResponse* response) override;
  grpc::ServerUnaryReactor* DeleteTraverse(grpc::CallbackServerContext* context,
                                           const v1::DeleteTraverseRequest* request,
                                           v1::DeleteTraverseResponse* response) override;

 private:
  UnaryDiskCall* NewCall(const MethodTraits& traits, grpc::CallbackServerContext& context) const;

  const TraverseBackend backend_;
  UploadOwners upload_owners_;
  const ChunkStream<ScanStreamSession>::Environment scan_streams_;
  const WatchStream::Environment watch_streams_;
  const MapStream::Environment map_streams_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_TRAVERSES_TRAVERSE_SERVICE_H_
