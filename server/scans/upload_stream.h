// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// One UploadScan call: chunks up, the committed offset down.
#ifndef CURVEREG_SERVER_SCANS_UPLOAD_STREAM_H_
#define CURVEREG_SERVER_SCANS_UPLOAD_STREAM_H_

#include <optional>

#include "absl/status/statusor.h"
#include "curvereg/v1/scan_service.pb.h"
#include "server/rpc/call.h"
#include "server/rpc/chunk_stream.h"
#include "server/scans/upload_message.h"
#include "server/scans/upload_session.h"
#include "server/scheduling/worker_pool.h"

namespace curvereg::server {

class UploadStream final : public ChunkStream<UploadMessage, v1::UploadScanResponse> {
 public:
  // Everything in it outlives the call.
  struct Environment {
    CallEnvironment calls;
    UploadEnvironment uploads;
    WorkerPool* disk_pool = nullptr;
  };
  UploadStream(const Environment& environment, grpc::CallbackServerContext& context);

 private:
  ~UploadStream() override = default;

  bool Parse(grpc::ByteBuffer& bytes, UploadMessage& message) const override { return message.Parse(bytes); }
  bool IsChunk(const UploadMessage& message) const override { return message.request().has_chunk(); }
  absl::StatusOr<std::optional<v1::UploadScanResponse>> Handle(UploadMessage& message) override;
  bool Supersedes(const v1::UploadScanResponse& newer, const v1::UploadScanResponse& older) const override;
  bool IsDone() const override { return is_done_; }
  std::optional<absl::Status> EndOfInput() const override;

  UploadSession session_;
  bool is_done_ = false;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_SCANS_UPLOAD_STREAM_H_
