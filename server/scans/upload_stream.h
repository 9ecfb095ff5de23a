// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The streaming of one UploadScan call: while the disk pool works on some messages, the next few are being read, and no
// more than that. An idle stream holds no thread and next to no memory.
#ifndef CURVEREG_SERVER_SCANS_UPLOAD_STREAM_H_
#define CURVEREG_SERVER_SCANS_UPLOAD_STREAM_H_

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <vector>

#include "absl/status/statusor.h"
#include "curvereg/v1/scan_service.pb.h"
#include "server/call.h"
#include "server/scans/upload_message.h"
#include "server/scans/upload_session.h"
#include "server/scheduling/worker_pool.h"

namespace curvereg::server {

// Reactions of gRPC, the end of a task, a takeover and the server's draining are events: each changes the state under
// the mutex and calls Advance, the one place that starts anything.
//
// Life: the object deletes itself in OnDone, which gRPC calls after Finish and after the reactions to all reads and
// writes. Finish is called once, when no task is out and nothing is being written; whoever calls it touches the object
// no more. Takeover and draining may come at any time: the destructors of their callbacks wait for one under way.
class UploadStream final : public grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer> {
 public:
  // Everything in it outlives the call.
  struct Environment {
    CallEnvironment calls;
    UploadEnvironment uploads;
    WorkerPool* disk_pool = nullptr;
  };
  UploadStream(const Environment& environment, grpc::CallbackServerContext& context);

  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override { delete this; }

 private:
  ~UploadStream() override = default;

  absl::Status Work();  // the task: puts what the session makes of taken_ into worked_
  void OnWorked(const absl::Status& status);
  void OnReplaced();

  // These with the mutex held. Advance gives the lock back.
  void End(const absl::Status& status);  // the first reason counts
  void EndIfIdle();
  void TakeArrived();  // for one task: the chunks in front, or one message of another kind
  void Advance(std::unique_lock<std::mutex> lock);
  void FinishCall(std::unique_lock<std::mutex> lock);

  const Environment& environment_;
  grpc::CallbackServerContext& context_;
  Call call_;

  std::mutex mutex_;
  bool reading_ = false;                          // into received_ and arriving_
  bool working_ = false;                          // a task is out; taken_, worked_ and session_ are its own
  bool writing_ = false;                          // written_
  bool finished_ = false;                         // FinishCall was called
  std::optional<absl::Status> input_end_;         // no more is read; why, unless `finish` came
  std::optional<v1::UploadScanResponse> answer_;  // to be written; a newer one takes its place
  std::optional<absl::Status> end_;               // nothing new is begun; OK: answer_ is `done`
  grpc::ByteBuffer received_;
  UploadMessage arriving_;
  std::vector<UploadMessage> arrived_;  // no task has taken them yet
  std::vector<UploadMessage> taken_;
  grpc::ByteBuffer written_;
  absl::StatusOr<v1::UploadScanResponse> worked_;

  const std::stop_source replaced_;
  UploadSession session_;
  // Last, so that they are gone before what they use.
  const std::stop_callback<std::function<void()>> on_replaced_;
  const std::stop_callback<std::function<void()>> on_draining_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_SCANS_UPLOAD_STREAM_H_
