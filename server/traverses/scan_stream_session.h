// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What a StreamScans call does with its messages, apart from the streaming: one upload after the other into the store,
// each scan then made part of the traverse. Runs on the disk pool.
#ifndef CURVEREG_SERVER_TRAVERSES_SCAN_STREAM_SESSION_H_
#define CURVEREG_SERVER_TRAVERSES_SCAN_STREAM_SESSION_H_

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "curvereg/v1/traverse_service.pb.h"
#include "server/scans/upload_session.h"
#include "server/traverses/traverses.h"

namespace curvereg::server {

class ScanStreamSession {
 public:
  // What sessions share; all outlive them. The owners may be those of the uploads of ScanService.
  struct Environment {
    UploadEnvironment uploads;
    Traverses* traverses = nullptr;
  };
  // `replaced` is requested to stop when another stream takes the traverse over. `wake` is called when there may be new
  // results; it is quick and does not call back into here.
  ScanStreamSession(const Environment& environment, std::stop_source replaced, std::function<void()> wake)
      : environment_(environment), replaced_(std::move(replaced)), wake_(std::move(wake)) {}
  ScanStreamSession(const ScanStreamSession&) = delete;
  ScanStreamSession& operator=(const ScanStreamSession&) = delete;

  // Does what the message asks. Answers `start` with ready, a header with an ack (of what is there of the scan), and a
  // chunk with an ack or, where it brings nothing new, with nothing. Chunks of bytes that are there are checked and
  // left out, for clients need not wait for the ack of a header. Errors as the contract has them; what is committed
  // then stays, except where a payload as a whole is wrong. One thread at a time, as for all that follows.
  absl::StatusOr<std::optional<v1::StreamScansResponse>> Handle(v1::StreamScansRequest& request);

  bool has_started() const { return ticket_.has_value(); }
  // No scan is announced and incomplete.
  bool is_between_scans() const { return !scan_.has_value() || scan_->is_complete; }

  // The next results, in order, at most `max_results`. Empty: there are none before the next wake. Precondition:
  // started.
  absl::StatusOr<std::vector<v1::ScanResult>> TakeResults(int max_results);
  // Everything acknowledged, but scans that came before one that is missing, had its result taken.
  bool took_all_results() const { return next_result_ >= next_sequence_number_; }

 private:
  // The scan announced last.
  struct StreamedScan {
    v1::StreamedScanHeader header;
    uint64_t committed_offset = 0;
    bool is_complete = false;
  };
  using Answer = absl::StatusOr<std::optional<v1::StreamScansResponse>>;

  Answer Start(const v1::StreamScansStart& start);
  Answer Announce(v1::StreamedScanHeader& header);
  Answer BeginUpload();
  Answer Append(v1::PayloadChunk& chunk);
  Answer Finish();
  Answer AddToTraverse(const std::string& scan_name);
  absl::StatusOr<v1::UploadScanResponse> StartUpload();
  absl::StatusOr<v1::UploadScanResponse> Upload(v1::UploadScanRequest request);
  absl::Status CheckChunk(const v1::PayloadChunk& chunk) const;
  v1::StreamScansResponse Complete(const std::string& scan_id);
  v1::StreamScansResponse Ack() const;

  const Environment& environment_;
  const std::stop_source replaced_;
  const std::function<void()> wake_;
  std::string name_;  // of the traverse
  std::optional<StreamTicket> ticket_;
  uint64_t next_sequence_number_ = 0;  // least not acknowledged
  uint64_t next_result_ = 0;           // sequence number
  std::optional<StreamedScan> scan_;
  std::unique_ptr<UploadSession> upload_;  // of scan_, until it is complete
  // Last, so that nothing wakes us when the rest is gone.
  std::unique_ptr<Subscription> subscription_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_TRAVERSES_SCAN_STREAM_SESSION_H_
