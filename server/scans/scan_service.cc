// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/scans/scan_service.h"

#include <utility>

#include "server/scans/scan_conversion.h"
#include "server/store/page_token.h"
#include "wire/resource_names.h"
#include "wire/timestamp.h"

namespace curvereg::server {
namespace {

constexpr const char* kService = v1::ScanService::service_full_name();
constexpr MethodTraits kUploadScan = {kService, "UploadScan", Scope::kWrite};
constexpr MethodTraits kGetUpload = {kService, "GetUpload", Scope::kRead};
constexpr MethodTraits kGetScan = {kService, "GetScan", Scope::kRead};
constexpr MethodTraits kListScans = {kService, "ListScans", Scope::kRead};
constexpr MethodTraits kDeleteScan = {kService, "DeleteScan", Scope::kWrite};

absl::Status GetUploadWork(ScanStore& store, const v1::GetUploadRequest& request, v1::GetUploadResponse& response) {
  const absl::StatusOr<std::string> id = wire::UploadIdOf(request.upload(), "upload");
  if (!id.ok()) return id.status();
  const absl::StatusOr<UploadState> upload = store.GetUpload(*id);
  if (!upload.ok()) return upload.status();
  response.set_upload(request.upload());
  response.set_committed_offset(upload->committed_offset);
  response.set_payload_bytes(upload->description.payload_bytes);
  *response.mutable_expire_time() = wire::TimestampOf(upload->expire_time);
  return absl::OkStatus();
}

absl::Status GetScanWork(ScanStore& store, const v1::GetScanRequest& request, v1::GetScanResponse& response) {
  const absl::StatusOr<std::string> id = wire::ScanIdOf(request.name(), "name");
  if (!id.ok()) return id.status();
  const absl::StatusOr<StoredScan> scan = store.GetScan(*id);
  if (!scan.ok()) return scan.status();
  *response.mutable_scan() = ToWire(*scan);
  return absl::OkStatus();
}

absl::Status ListScansWork(ScanStore& store, const v1::ListScansRequest& request, v1::ListScansResponse& response) {
  const absl::StatusOr<int> page_size = PageSize(request.page_size());
  if (!page_size.ok()) return page_size.status();
  absl::StatusOr<ScanPage> page = store.ListScans(*page_size, request.page_token());
  if (!page.ok()) return page.status();
  for (const StoredScan& scan : page->scans) *response.add_scans() = ToWire(scan);
  response.set_next_page_token(std::move(page->next_page_token));
  return absl::OkStatus();
}

absl::Status DeleteScanWork(const ScanBackend& backend, const v1::DeleteScanRequest& request) {
  const absl::StatusOr<std::string> id = wire::ScanIdOf(request.name(), "name");
  return id.ok() ? backend.delete_scan(*id) : id.status();
}

}  // namespace

ScanService::ScanService(const ScanBackend& backend)
    : backend_(backend),
      uploads_{backend.calls,
               {backend.limits, backend.memory, backend.store, backend.calls.metrics, &upload_owners_},
               backend.disk_pool},
      downloads_{backend.calls, backend.limits, backend.store, backend.disk_pool} {
  Check(backend.calls, DownloadStream::kTraits, &ScanService::DownloadScan);
  Check(backend.calls, kGetUpload, &ScanService::GetUpload);
  Check(backend.calls, kGetScan, &ScanService::GetScan);
  Check(backend.calls, kListScans, &ScanService::ListScans);
  Check(backend.calls, kDeleteScan, &ScanService::DeleteScan);
}

grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* ScanService::UploadScan(
    grpc::CallbackServerContext* context) {
  return new ChunkStream<UploadSession>(uploads_, kUploadScan, *context);
}

grpc::ServerWriteReactor<v1::DownloadScanResponse>* ScanService::DownloadScan(grpc::CallbackServerContext* context,
                                                                              const v1::DownloadScanRequest* request) {
  return new DownloadStream(downloads_, *context, *request);
}

UnaryDiskCall* ScanService::NewCall(const MethodTraits& traits, grpc::CallbackServerContext& context) const {
  return new UnaryDiskCall(*backend_.disk_pool, backend_.calls, traits, context);
}

grpc::ServerUnaryReactor* ScanService::GetUpload(grpc::CallbackServerContext* context,
                                                 const v1::GetUploadRequest* request, v1::GetUploadResponse* response) {
  return NewCall(kGetUpload, *context)->Start([this, request, response] {
    return GetUploadWork(*backend_.store, *request, *response);
  });
}

grpc::ServerUnaryReactor* ScanService::GetScan(grpc::CallbackServerContext* context, const v1::GetScanRequest* request,
                                               v1::GetScanResponse* response) {
  return NewCall(kGetScan, *context)->Start([this, request, response] {
    return GetScanWork(*backend_.store, *request, *response);
  });
}

grpc::ServerUnaryReactor* ScanService::ListScans(grpc::CallbackServerContext* context,
                                                 const v1::ListScansRequest* request, v1::ListScansResponse* response) {
  return NewCall(kListScans, *context)->Start([this, request, response] {
    return ListScansWork(*backend_.store, *request, *response);
  });
}

grpc::ServerUnaryReactor* ScanService::DeleteScan(grpc::CallbackServerContext* context,
                                                  const v1::DeleteScanRequest* request, v1::DeleteScanResponse*) {
  return NewCall(kDeleteScan, *context)->Start([this, request] { return DeleteScanWork(backend_, *request); });
}

}  // namespace curvereg::server
