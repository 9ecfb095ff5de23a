// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// ScanService: the store over the wire. Disk work and decoding happen on a pool of their own, never in a reactor.
#ifndef CURVEREG_SERVER_SCANS_SCAN_SERVICE_H_
#define CURVEREG_SERVER_SCANS_SCAN_SERVICE_H_

#include <functional>
#include <string>

#include "curvereg/v1/scan_service.grpc.pb.h"
#include "server/rpc/call.h"
#include "server/rpc/checked_service.h"
#include "server/rpc/chunk_stream.h"
#include "server/rpc/unary_disk_call.h"
#include "server/scans/download_stream.h"
#include "server/scans/upload_session.h"
#include "server/scheduling/memory_budget.h"
#include "server/scheduling/worker_pool.h"
#include "server/settings/server_config.h"
#include "server/store/scan_store.h"

namespace curvereg::server {

// What the service works with. All outlive it.
struct ScanBackend {
  CallEnvironment calls;
  LimitsConfig limits;              // resolved
  WorkerPool* disk_pool = nullptr;  // its queue is bounded by the open streams: each has at most one task in it
  MemoryBudget* memory = nullptr;
  ScanStore* store = nullptr;
  // On the disk pool: deletes a scan from the store and all that is kept of it elsewhere. SCAN_NOT_FOUND, SCAN_IN_USE.
  std::function<absl::Status(const std::string& scan_id)> delete_scan;
};

// As protobuf's CallbackService, but for the raw messages of UploadScan.
using ScanServiceBase = v1::ScanService::WithRawCallbackMethod_UploadScan<
    v1::ScanService::WithCallbackMethod_DownloadScan<v1::ScanService::WithCallbackMethod_GetUpload<
        v1::ScanService::WithCallbackMethod_GetScan<v1::ScanService::WithCallbackMethod_ListScans<
            v1::ScanService::WithCallbackMethod_DeleteScan<v1::ScanService::Service>>>>>>;

class ScanService final : public CheckedService<ScanServiceBase> {
 public:
  explicit ScanService(const ScanBackend& backend);

  grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* UploadScan(
      grpc::CallbackServerContext* context) override;
  grpc::ServerWriteReactor<v1::DownloadScanResponse>* DownloadScan(grpc::CallbackServerContext* context,
                                                                   const v1::DownloadScanRequest* request) override;
  grpc::ServerUnaryReactor* GetUpload(grpc::CallbackServerContext* context, const v1::GetUploadRequest* request,
                                      v1::GetUploadResponse* response) override;
  grpc::ServerUnaryReactor* GetScan(grpc::CallbackServerContext* context, const v1::GetScanRequest* request,
                                    v1::GetScanResponse* response) override;
  grpc::ServerUnaryReactor* ListScans(grpc::CallbackServerContext* context, const v1::ListScansRequest* request,
                                      v1::ListScansResponse* response) override;
  grpc::ServerUnaryReactor* DeleteScan(grpc::CallbackServerContext* context, const v1::DeleteScanRequest* request,
                                       v1::DeleteScanResponse* response) override;

 private:
  UnaryDiskCall* NewCall(const MethodTraits& traits, grpc::CallbackServerContext& context) const;

  const ScanBackend backend_;
  UploadOwners upload_owners_;
  const ChunkStream<UploadSession>::Environment uploads_;
  const DownloadStream::Environment downloads_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_SCANS_SCAN_SERVICE_H_
