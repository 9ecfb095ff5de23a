// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/scans/upload_stream.h"

#include <utility>

#include "curvereg/v1/scan_service.grpc.pb.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

constexpr MethodTraits kTraits = {v1::ScanService::service_full_name(), "UploadScan", Scope::kWrite};

}  // namespace

UploadStream::UploadStream(const Environment& environment, grpc::CallbackServerContext& context)
    : ChunkStream(environment.calls, kTraits, *environment.disk_pool, context),
      session_(environment.uploads, replaced()) {
  Begin();
}

absl::StatusOr<std::optional<v1::UploadScanResponse>> UploadStream::Handle(UploadMessage& message) {
  absl::StatusOr<v1::UploadScanResponse> answer = session_.Handle(message);
  if (!answer.ok()) return answer.status();
  is_done_ = answer->has_done();
  return *std::move(answer);
}

bool UploadStream::Supersedes(const v1::UploadScanResponse& /*newer*/, const v1::UploadScanResponse& older) const {
  return older.has_progress();  // the latest offset is enough, and done tells all
}

std::optional<absl::Status> UploadStream::EndOfInput() const {
  return wire::MakeError(v1::ERROR_REASON_UNEXPECTED_MESSAGE, "the stream ended before finish");
}

}  // namespace curvereg::server
