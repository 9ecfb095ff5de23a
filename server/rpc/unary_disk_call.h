// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A call with one request and one answer, whose work is one task of the disk pool.
#ifndef CURVEREG_SERVER_RPC_UNARY_DISK_CALL_H_
#define CURVEREG_SERVER_RPC_UNARY_DISK_CALL_H_

#include <grpcpp/support/server_callback.h>

#include <functional>

#include "absl/status/status.h"
#include "server/rpc/call.h"
#include "server/scheduling/worker_pool.h"

namespace curvereg::server {

// Finish is called once, when the task is over or was refused. After that the object belongs to gRPC, which calls
// OnDone.
class UnaryDiskCall final : public grpc::ServerUnaryReactor {
 public:
  // `pool` outlives the call.
  UnaryDiskCall(WorkerPool& pool, const CallEnvironment& calls, const MethodTraits& traits,
                grpc::CallbackServerContext& context)
      : pool_(pool), call_(calls, traits, context) {}

  // `work` uses request and response, which gRPC keeps until OnDone. Once.
  grpc::ServerUnaryReactor* Start(std::function<absl::Status()> work);

  void OnCancel() override { call_.Cancel(); }  // a task that waits is dropped; one that runs ends soon
  void OnDone() override { delete this; }

 private:
  ~UnaryDiskCall() override = default;
  void End(const absl::Status& status);

  WorkerPool& pool_;
  Call call_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_RPC_UNARY_DISK_CALL_H_
