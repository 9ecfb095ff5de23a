// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/registration/computing_call.h"

#include <exception>
#include <functional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

// The one place where exceptions of libraries (want of memory above all) are caught.
absl::Status Caught(const std::function<absl::Status()>& work) {
  try {
    return work();
  } catch (const std::exception& error) {
    return absl::InternalError(absl::StrCat("a library threw: ", error.what()));
  }
}

}  // namespace

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
  absl::StatusOr<MemoryBudget::Reservation> reservation = backend_.memory->Reserve(*bytes);
  if (!reservation.ok()) return reservation.status();
  reservation_ = *std::move(reservation);
  return backend_.pool->Submit({.client = call_.client(),
                                .cancellation = call_.stop().cancellation,
                                .run =
                                    [this](std::chrono::nanoseconds waited) {
                                      backend_.calls.metrics->QueueWaited(waited);
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

void ComputingCall::End(absl::Status status) {
  Release();
  reservation_ = MemoryBudget::Reservation();
  // At the deadline gRPC cancels the call; tell what it was.
  if (absl::IsCancelled(status) && call_.stop().PastDeadline()) {
    status = wire::MakeError(v1::ERROR_REASON_DEADLINE_EXCEEDED, "the deadline of the call passed");
  }
  if (status.ok()) call_.CountSent();
  Finish(call_.Finish(status));
}

}  // namespace curvereg::server
