// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The streaming of one StreamScans call: as UploadStream on the way up, with results on the way down. While the disk
// pool works on some messages the next few are being read, and no more than that; results are read from the traverse a
// few at a time, when those before are written.
#ifndef CURVEREG_SERVER_TRAVERSES_SCAN_STREAM_H_
#define CURVEREG_SERVER_TRAVERSES_SCAN_STREAM_H_

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <vector>

#include "absl/status/statusor.h"
#include "curvereg/v1/traverse_service.pb.h"
#include "server/call.h"
#include "server/scheduling/worker_pool.h"
#include "server/traverses/scan_stream_session.h"

namespace curvereg::server {

// Reactions of gRPC, the end of a task, a takeover, a wake of the traverse and the server's draining are events: each
// changes the state under the mutex and calls Advance, the one place that starts anything. Life as in upload_stream.h:
// the object deletes itself in OnDone; Finish is called once, when no task is out and nothing is being written.
class ScanStream final : public grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer> {
 public:
  // Everything in it outlives the call.
  struct Environment {
    CallEnvironment calls;
    ScanStreamSession::Environment session;
    WorkerPool* disk_pool = nullptr;
  };
  ScanStream(const Environment& environment, grpc::CallbackServerContext& context);

  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override { delete this; }

 private:
  ~ScanStream() override = default;

  // The task: handles taken_ and, when asked to, reads on in the results.
  absl::Status Work();
  absl::Status Handle();
  void OnWorked(const absl::Status& status);
  void OnReplaced();
  void OnWake();

  // These with the mutex held. Advance gives the lock back.
  void End(const absl::Status& status);        // the first reason counts
  void Interrupt(const absl::Status& status);  // End, and nothing more is written
  void EndIfIdle();
  void TakeArrived();  // as in UploadStream
  bool TakeWork();     // what there is to do for one task; false: nothing
  void Write();        // the next answer or result, if there is any
  void Advance(std::unique_lock<std::mutex> lock);

  const Environment& environment_;
  grpc::CallbackServerContext& context_;
  Call call_;

  std::mutex mutex_;
  bool reading_ = false;      // into received_ and arriving_
  bool working_ = false;      // a task is out; taken_, wants_results_, worked_, found_ and session_ are its own
  bool writing_ = false;      // written_
  bool finished_ = false;     // Finish was called, or is about to be
  bool results_due_ = false;  // there may be results that we have not got
  std::optional<absl::Status> input_end_;  // no more is read; OK: the client is done
  std::optional<absl::Status> end_;        // nothing new is begun
  grpc::ByteBuffer received_;
  v1::StreamScansRequest arriving_;
  std::vector<v1::StreamScansRequest> arrived_;  // no task has taken them yet
  std::deque<v1::StreamScansResponse> answers_;  // to be written, before results
  std::deque<v1::ScanResult> results_;           // to be written
  grpc::ByteBuffer written_;

  std::vector<v1::StreamScansRequest> taken_;
  bool wants_results_ = false;
  std::optional<v1::StreamScansResponse> worked_;
  std::vector<v1::ScanResult> found_;

  const std::stop_source replaced_;
  ScanStreamSession session_;
  // Last, so that they are gone before what they use.
  const std::stop_callback<std::function<void()>> on_replaced_;
  const std::stop_callback<std::function<void()>> on_draining_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_TRAVERSES_SCAN_STREAM_H_
