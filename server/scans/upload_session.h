// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The session of an UploadScan call: its messages checked, handed to the intake and answered. Runs on the disk pool.
#ifndef CURVEREG_SERVER_SCANS_UPLOAD_SESSION_H_
#define CURVEREG_SERVER_SCANS_UPLOAD_SESSION_H_

#include <grpcpp/support/byte_buffer.h>

#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "curvereg/v1/scan_service.pb.h"
#include "server/rpc/stream_session.h"
#include "server/scans/scan_intake.h"
#include "server/scans/upload_message.h"

namespace curvereg::server {

// A session as ChunkStream has it; see server/rpc/stream_session.h.
class UploadSession {
 public:
  using Environment = UploadEnvironment;
  using Request = UploadMessage;
  using Response = v1::UploadScanResponse;
  using Answer = absl::StatusOr<std::optional<Response>>;

  UploadSession(const Environment& environment, const StreamHandle& stream)
      : environment_(environment), intake_(environment, stream.replaced) {}
  UploadSession(const UploadSession&) = delete;
  UploadSession& operator=(const UploadSession&) = delete;

  static bool Parse(const grpc::ByteBuffer& bytes, Request& message) { return message.Parse(bytes); }
  static bool IsChunk(const Request& message) { return message.request().has_chunk(); }

  // Does what the message asks and returns the answer: ready, progress, or done. Errors as the contract has them; what
  // is committed then stays, except where the payload as a whole is wrong (DIGEST_MISMATCH, MALFORMED_PAYLOAD): that
  // upload is forgotten. One thread at a time.
  Answer Handle(Request& message);
  absl::Status TakeNotifications(std::vector<Response>& /*notifications*/) { return absl::OkStatus(); }  // none

  // The latest offset is enough, and done implies all before.
  static bool Supersedes(const Response& /*newer*/, const Response& older) { return older.has_progress(); }
  bool is_done() const { return is_done_; }
  std::optional<absl::Status> EndOfInput() const;  // UNEXPECTED_MESSAGE

 private:
  Answer Start(v1::UploadScanStart& start);
  Answer Append(const UploadMessage& message);
  Answer Finish(const v1::UploadScanFinish& finish);
  Response Done(const StoredScan& scan, bool already_stored);

  const Environment& environment_;
  ScanIntake intake_;
  bool is_done_ = false;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_SCANS_UPLOAD_SESSION_H_
