// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/unary_disk_call.h"

#include <utility>

#include "server/rpc/call_task.h"

namespace curvereg::server {

grpc::ServerUnaryReactor* UnaryDiskCall::Start(std::function<absl::Status()> work) {
  grpc::ServerUnaryReactor* const reactor = this;
  call_.CountReceived();
  if (call_.admitted().ok()) {
    RunOnPool(pool_, call_, {std::move(work), [this](const absl::Status& status) { End(status); }});
  } else {
    End(call_.admitted());
  }
  return reactor;
}

void UnaryDiskCall::End(const absl::Status& status) {
  if (status.ok()) call_.CountSent();
  Finish(call_.Finish(status));
}

}  // namespace curvereg::server
