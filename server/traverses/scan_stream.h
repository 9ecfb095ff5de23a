// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// One StreamScans call: scans up, acknowledgements and results down. Results are read from the traverse a few at a
// time, when those before are written.
#ifndef CURVEREG_SERVER_TRAVERSES_SCAN_STREAM_H_
#define CURVEREG_SERVER_TRAVERSES_SCAN_STREAM_H_

#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "curvereg/v1/traverse_service.pb.h"
#include "server/rpc/call.h"
#include "server/rpc/chunk_stream.h"
#include "server/scheduling/worker_pool.h"
#include "server/traverses/scan_stream_session.h"

namespace curvereg::server {

class ScanStream final : public ChunkStream<v1::StreamScansRequest, v1::StreamScansResponse> {
 public:
  // Everything in it outlives the call.
  struct Environment {
    CallEnvironment calls;
    ScanStreamSession::Environment session;
    WorkerPool* disk_pool = nullptr;
  };
  ScanStream(const Environment& environment, grpc::CallbackServerContext& context);

 private:
  ~ScanStream() override = default;

  bool Parse(grpc::ByteBuffer& bytes, v1::StreamScansRequest& request) const override;
  bool IsChunk(const v1::StreamScansRequest& request) const override { return request.has_chunk(); }
  absl::StatusOr<std::optional<v1::StreamScansResponse>> Handle(v1::StreamScansRequest& request) override;
  absl::Status TakeNews(std::vector<v1::StreamScansResponse>& news) override;  // results
  bool Supersedes(const v1::StreamScansResponse& newer, const v1::StreamScansResponse& older) const override;
  std::optional<absl::Status> EndOfInput() const override;

  ScanStreamSession session_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_TRAVERSES_SCAN_STREAM_H_
