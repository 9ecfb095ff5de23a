// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/traverse_watch.h"

#include <chrono>
#include <memory>

#include "client/retry.h"
#include "client/traverse_conversion.h"
#include "curvereg/v1/traverse_service.grpc.pb.h"
#include "wire/error.h"

namespace curvereg::internal {
namespace {

using Clock = std::chrono::steady_clock;

// A stream that lived so long worked, though nothing may have happened.
constexpr std::chrono::seconds kProof(1);

// There is no event of the first one's number, and none will be soon.
bool IsWorthAnother(const absl::Status& error) {
  return IsResumable(error) && wire::ReasonOf(error) != v1::ERROR_REASON_OFFSET_OUT_OF_RANGE;
}

// One stream; gRPC's pings notice a dead link, for a traverse on which nothing happens is silent.
absl::Status WatchOnce(Connection& connection, const std::shared_ptr<grpc::Channel>& channel,
                       const v1::WatchTraverseRequest& request, const std::stop_token& cancellation,
                       const std::function<absl::Status(const v1::WatchTraverseResponse&)>& take) {
  grpc::ClientContext context;
  connection.Prepare(context);
  const std::stop_callback cancel(cancellation, [&context] { context.TryCancel(); });
  const auto reader = v1::TraverseService::NewStub(channel)->WatchTraverse(&context, request);
  absl::Status taken;
  for (v1::WatchTraverseResponse event; taken.ok() && reader->Read(&event);) taken = take(event);
  if (!taken.ok()) context.TryCancel();
  const grpc::Status status = reader->Finish();
  if (!taken.ok()) return taken;
  return status.ok() ? absl::OkStatus() : CallError(status, context);
}

}  // namespace

absl::Status WatchTraverse(Connection& connection, const std::string& name, const WatchOptions& options,
                           const std::function<void(const TraverseEvent&)>& on_event) {
  Retrier retrier(connection, {options.cancellation, connection.options().call_timeout, IsWorthAnother,
                               /*until_timeout=*/true});
  v1::WatchTraverseRequest request;
  request.set_name(name);
  request.set_first_event(options.first_event);
  request.set_existing_only(options.existing_only);
  const auto take = [&](const v1::WatchTraverseResponse& message) {
    if (message.event() != request.first_event()) return absl::InternalError("the server left out an event");
    const absl::StatusOr<TraverseEvent> event = FromWire(message);
    if (!event.ok()) return event.status();
    request.set_first_event(message.event() + 1);
    retrier.NoteProgress();
    on_event(*event);
    return absl::OkStatus();
  };
  return retrier.Run([&](const std::shared_ptr<grpc::Channel>& channel) {
    const Clock::time_point begin = Clock::now();
    const absl::Status ended =
        WatchOnce(connection, channel, v1::WatchTraverseRequest(request), options.cancellation, take);
    if (Clock::now() - begin > kProof) retrier.NoteProgress();
    if (options.cancellation.stop_requested()) return absl::CancelledError("cancelled by the caller");
    if (!ended.ok() || options.existing_only) return ended;
    return absl::UnavailableError("the server ended the stream of events");
  });
}

}  // namespace curvereg::internal
