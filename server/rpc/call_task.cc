// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/call_task.h"

#include <memory>
#include <utility>

#include "server/scheduling/caught.h"

namespace curvereg::server {

void RunOnPool(WorkerPool& pool, const Call& call, CallTask task) {
  const auto shared = std::make_shared<const CallTask>(std::move(task));
  const absl::Status accepted =
      pool.Submit({call.client(), call.stop().cancellation,
                   [shared](std::chrono::nanoseconds) { shared->finish(Caught(shared->work)); },
                   [shared](const absl::Status& reason) { shared->finish(reason); }});
  if (!accepted.ok()) shared->finish(accepted);
}

}  // namespace curvereg::server
