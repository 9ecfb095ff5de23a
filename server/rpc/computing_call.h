// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A call with one request and one answer that is computed on the worker pool:
// admitted -> checked -> memory reserved -> queued -> computed -> finished. Each step may end it with an error.
#ifndef CURVEREG_SERVER_RPC_COMPUTING_CALL_H_
#define CURVEREG_SERVER_RPC_COMPUTING_CALL_H_

#include <grpcpp/support/server_callback.h>

#include <cstdint>

#include "absl/status/statusor.h"
#include "server/rpc/call.h"
#include "server/scheduling/memory_budget.h"
#include "server/scheduling/worker_pool.h"

namespace curvereg::server {

class ComputingCall : public grpc::ServerUnaryReactor {
 public:
  // All outlive the call.
  struct Environment {
    const CallEnvironment& calls;
    MemoryBudget& memory;
    WorkerPool& pool;
  };
  ComputingCall(const Environment& environment, const MethodTraits& traits, grpc::CallbackServerContext& context)
      : environment_(environment), call_(environment.calls, traits, context) {}

  // Once, right after construction. The object deletes itself when gRPC is done with it, which may be before this
  // returns.
  grpc::ServerUnaryReactor* Start();

  void OnCancel() override { call_.Cancel(); }  // a task that waits is dropped; one that runs is stopped
  void OnDone() override { delete this; }

 protected:
  ~ComputingCall() override = default;

  // On the reactor's thread: checks the request; quick, takes no memory to speak of. The bytes to reserve, or an error.
  virtual absl::StatusOr<uint64_t> Check() = 0;
  // On a worker's thread: fills the response in. `stop` is requested when the caller cancels or its deadline passes.
  virtual absl::Status Compute(const Stop& stop) = 0;
  // After either: gives up what takes memory, before the reservation ends.
  virtual void Release() = 0;

 private:
  absl::Status Queue();
  void Run();
  void End(const absl::Status& status);

  const Environment environment_;
  Call call_;
  MemoryBudget::Reservation reservation_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_RPC_COMPUTING_CALL_H_
