// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/computing_call.h"

#include <functional>
#include <utility>

#include "server/scheduling/caught.h"

namespace curvereg::server {

grpc::ServerUnaryReactor* ComputingCall::Start() {
  grpc::ServerUnaryReactor* const reactor = this;
  call_.CountReceived();
  absl::Status status = call_.admitted();
  if (status.ok()) status = Caught([this] { return Queue(); });
  if (!status.ok()) End(status);  // else a worker has the object, and may have ended it already
  return reactor;
}

absl::Status ComputingCall::Queue() {
  const absl::StatusOr<uint64_t> bytes = Check();
  if (!bytes.ok()) return bytes.status();
  absl::StatusOr<MemoryBudget::Reservation> reservation = environment_.memory.Reserve(*bytes);
  if (!reservation.ok()) return reservation.status();
  reservation_ = *std::move(reservation);
  return environment_.pool.Submit({.client = call_.client(),
                                   .cancellation = call_.stop().cancellation,
                                   .run =
                                       [this](std::chrono::nanoseconds waited) {
                                         environment_.calls.metrics->QueueWaited(waited);
                                         Run();
                                       },
                                   .drop = [this](const absl::Status& reason) { End(reason); }});
}

void ComputingCall::Run() {
  const Stop stop = call_.stop();
  if (stop.Requested()) {
    End(absl::CancelledError("cancelled while waiting"));
  } else {
    End(Caught([&] { return Compute(stop); }));
  }
}

void ComputingCall::End(const absl::Status& status) {
  Release();
  reservation_ = MemoryBudget::Reservation();
  if (status.ok()) call_.CountSent();
  Finish(call_.Finish(status));
}

}  // namespace curvereg::server
