// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/traverses/watch_stream.h"

#include <iterator>
#include <utility>
#include <vector>

#include "curvereg/v1/traverse_service.grpc.pb.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

constexpr int kMostEvents = 8;  // read at once; a revision of many poses is large

}  // namespace

const MethodTraits WatchStream::kTraits = {v1::TraverseService::service_full_name(), "WatchTraverse", Scope::kRead};

WatchStream::WatchStream(const Environment& environment, grpc::CallbackServerContext& context,
                         const v1::WatchTraverseRequest& request)
    : ResponseStream(environment.calls, kTraits, context),
      environment_(environment),
      request_(request),
      next_event_(request.first_event()),
      on_draining_(environment.calls.draining, [this] {
        Interrupt(wire::MakeError(v1::ERROR_REASON_NOT_SERVING, "the server is about to stop; go on elsewhere"));
      }) {
  Begin();
}

absl::StatusOr<WatchStream::Next> WatchStream::Make(std::deque<v1::WatchTraverseResponse>& made) {
  // Before the first look, so that nothing is missed between the two.
  if (subscription_ == nullptr && !request_.existing_only()) {
    const absl::StatusOr<std::shared_ptr<TrackedTraverse>> watched = environment_.traverses->Find(request_.name());
    if (!watched.ok()) return watched.status();
    subscription_ = (*watched)->Subscribe([this] { Wake(); });
  }
  // Found anew: a deletion before the subscription wakes nobody.
  const absl::StatusOr<std::shared_ptr<TrackedTraverse>> traverse = environment_.traverses->Find(request_.name());
  if (!traverse.ok()) return traverse.status();
  absl::StatusOr<std::vector<v1::WatchTraverseResponse>> events = (*traverse)->Events(next_event_, kMostEvents);
  if (!events.ok()) return events.status();
  if (events->empty()) return request_.existing_only() ? Next::kEnd : Next::kAfterWake;
  next_event_ = events->back().event() + 1;
  made.assign(std::make_move_iterator(events->begin()), std::make_move_iterator(events->end()));
  return Next::kMore;
}

}  // namespace curvereg::server
