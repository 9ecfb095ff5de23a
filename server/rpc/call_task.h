// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A call's work on a worker pool. Its end is reported exactly once, also when the pool refuses or drops it.
#ifndef CURVEREG_SERVER_RPC_CALL_TASK_H_
#define CURVEREG_SERVER_RPC_CALL_TASK_H_

#include <functional>

#include "absl/status/status.h"
#include "server/rpc/call.h"
#include "server/scheduling/worker_pool.h"

namespace curvereg::server {

struct CallTask {
  std::function<absl::Status()> work;               // on a worker's thread
  std::function<void(const absl::Status&)> finish;  // with the status of `work`, or with the reason why it never ran
};

// Hands the task over. `finish` is called exactly once: after `work` on the worker's thread; else, when the pool
// refuses or drops the task, on this thread or on the one that cancels the call. So hold no lock that it takes. What
// `work` throws (out of memory) becomes INTERNAL.
void RunOnPool(WorkerPool& pool, const Call& call, CallTask task);

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_RPC_CALL_TASK_H_
