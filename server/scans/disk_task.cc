// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/scans/disk_task.h"

#include <exception>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"

namespace curvereg::server {
namespace {

absl::Status Caught(const std::function<absl::Status()>& work) {
  try {
    return work();
  } catch (const std::exception& error) {
    return absl::InternalError(absl::StrCat("a library threw: ", error.what()));
  }
}

}  // namespace

void RunOnDiskPool(WorkerPool& pool, const Call& call, DiskTask task) {
  const auto shared = std::make_shared<const DiskTask>(std::move(task));
  const absl::Status accepted =
      pool.Submit({call.client(), call.stop().cancellation,
                   [shared](std::chrono::nanoseconds) { shared->finish(Caught(shared->work)); },
                   [shared](const absl::Status& reason) { shared->finish(reason); }});
  if (!accepted.ok()) shared->finish(accepted);
}

}  // namespace curvereg::server
