// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The session of a StreamScans call: one payload after the other into the store, each scan then made part of the
// traverse; acknowledgements as answers, results as notifications. Runs on the disk pool.
#ifndef CURVEREG_SERVER_TRAVERSES_SCAN_STREAM_SESSION_H_
#define CURVEREG_SERVER_TRAVERSES_SCAN_STREAM_SESSION_H_

#include <grpcpp/support/byte_buffer.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "curvereg/v1/traverse_service.pb.h"
#include "server/rpc/stream_session.h"
#include "server/scans/scan_intake.h"
#include "server/traverses/traverses.h"

namespace curvereg::server {

// A session as ChunkStream has it; see server/rpc/stream_session.h.
class ScanStreamSession {
 public:
  // What sessions share; all outlive them. The owners may be those of the uploads of ScanService.
  struct Environment {
    UploadEnvironment uploads;
    Traverses* traverses = nullptr;
  };
  using Request = v1::StreamScansRequest;
  using Response = v1::StreamScansResponse;
  using Answer = absl::StatusOr<std::optional<Response>>;

  ScanStreamSession(const Environment& environment, StreamHandle stream)
      : environment_(environment), stream_(std::move(stream)) {}
  ScanStreamSession(const ScanStreamSession&) = delete;
  ScanStreamSession& operator=(const ScanStreamSession&) = delete;

  static bool Parse(grpc::ByteBuffer& bytes, Request& request);
  static bool IsChunk(const Request& request) { return request.has_chunk(); }

  // Does what the message asks. Answers `start` with ready, a header with an ack (of what is there of the scan), and a
  // chunk with an ack or, where it brings nothing new, with nothing. Chunks of bytes that are there are checked and
  // left out, for clients need not wait for the ack of a header. Errors as the contract has them; what is committed
  // then stays, except where a payload as a whole is wrong. One thread at a time, as for all that follows.
  Answer Handle(Request& request);

  // The next few results, in order.
  absl::Status TakeNotifications(std::vector<Response>& notifications);
  // The next results, at most `max_results`. Empty: there are none before the next wake. Precondition: started.
  absl::StatusOr<std::vector<v1::ScanResult>> TakeResults(int max_results);

  bool has_started() const { return ticket_.has_value(); }
  // Everything acknowledged, but scans that came before one that is missing, had its result taken.
  bool took_all_results() const { return next_result_ >= next_sequence_number_; }

  static bool Supersedes(const Response& newer, const Response& older);
  bool is_done() const { return false; }  // the client ends the stream
  std::optional<absl::Status> EndOfInput() const;

 private:
  // The scan announced last.
  struct AnnouncedScan {
    v1::StreamedScanHeader header;
    bool is_complete = false;
  };

  // No scan is announced and incomplete.
  bool IsBetweenScans() const { return !scan_.has_value() || scan_->is_complete; }
  Answer Start(const v1::StreamScansStart& start);
  Answer Announce(v1::StreamedScanHeader& header);
  Answer BeginUpload();
  Answer Append(const v1::PayloadChunk& chunk);
  Answer Progress();
  Answer AddToTraverse(const std::string& scan_id);
  UploadDescription Describe() const;
  Response Ack() const;

  const Environment& environment_;
  const StreamHandle stream_;
  std::string name_;  // of the traverse
  std::optional<StreamTicket> ticket_;
  uint64_t next_sequence_number_ = 0;  // least not acknowledged
  uint64_t next_result_ = 0;           // sequence number
  std::optional<AnnouncedScan> scan_;
  std::optional<ScanIntake> intake_;  // of scan_
  // Last: it is destroyed first, so that `wake` is not called while the rest is destroyed.
  std::unique_ptr<Subscription> subscription_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_TRAVERSES_SCAN_STREAM_SESSION_H_
