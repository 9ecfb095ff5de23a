// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// One WatchTraverse call. Events are read a few at a time, when those before are written, so that a slow watcher costs
// no memory.
#ifndef CURVEREG_SERVER_TRAVERSES_WATCH_STREAM_H_
#define CURVEREG_SERVER_TRAVERSES_WATCH_STREAM_H_

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <stop_token>

#include "curvereg/v1/traverse_service.pb.h"
#include "server/rpc/call.h"
#include "server/rpc/response_stream.h"
#include "server/scheduling/worker_pool.h"
#include "server/traverses/traverses.h"

namespace curvereg::server {

class WatchStream final : public ResponseStream<v1::WatchTraverseResponse> {
 public:
  static const MethodTraits kTraits;

  // Everything in it outlives the call.
  struct Environment {
    CallEnvironment calls;
    Traverses* traverses = nullptr;
    WorkerPool* disk_pool = nullptr;
  };
  // `request` is gRPC's, which keeps it until OnDone.
  WatchStream(const Environment& environment, grpc::CallbackServerContext& context,
              const v1::WatchTraverseRequest& request);

 private:
  ~WatchStream() override = default;

  absl::StatusOr<Next> Make(std::deque<v1::WatchTraverseResponse>& made) override;
  WorkerPool& pool() override { return *environment_.disk_pool; }

  const Environment& environment_;
  const v1::WatchTraverseRequest& request_;
  uint64_t next_event_;
  // Last, so that they are gone before what they use.
  std::unique_ptr<Subscription> subscription_;
  const std::stop_callback<std::function<void()>> on_draining_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_TRAVERSES_WATCH_STREAM_H_
