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
    absl::StatusOr<std::unique_ptr<Traverses::Subscription>> subscription =
        environment_.traverses->Subscribe(request_.name(), [this] { Wake(); });
    if (!subscription.ok()) return subscription.status();
    subscription_ = *std::move(subscription);
  }
  absl::StatusOr<std::vector<v1::WatchTraverseResponse>> events =
      environment_.traverses->Events(request_.name(), next_event_, kMostEvents);
  if (!events.ok()) return events.status();
  if (events->empty()) return request_.existing_only() ? Next::kEnd : Next::kAfterWake;
  next_event_ = events->back().event() + 1;
  made.assign(std::make_move_iterator(events->begin()), std::make_move_iterator(events->end()));
  return Next::kMore;
}

}  // namespace curvereg::server
