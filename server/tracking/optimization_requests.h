// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Optimisations of one traverse that were asked for and wait for their turn.
#ifndef CURVEREG_SERVER_TRACKING_OPTIMIZATION_REQUESTS_H_
#define CURVEREG_SERVER_TRACKING_OPTIMIZATION_REQUESTS_H_

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "absl/status/status.h"
#include "core/base/stop.h"
#include "curvereg/v1/traverse_service.pb.h"
#include "server/tracking/traverse_types.h"

namespace curvereg::server {

// Its `stop` is requested when the caller's is and when the traverse is closed.
class OptimizationRequest {
 public:
  OptimizationRequest(const v1::OptimizeTraverseRequest& asked_for, std::string of_client, const Stop& of_caller,
                      OptimizeDone when_done);
  // Once, by whoever has made it.
  void StopWith(const std::stop_token& caller, const std::stop_token& closing);

  const v1::OptimizeTraverseRequest& request() const { return request_; }
  const std::string& client() const { return client_; }  // whose turn it takes
  const Stop& stop() const { return stop_; }
  // Once, without a lock: the caller's own code runs.
  void Finish(absl::StatusOr<v1::OptimizeTraverseResponse> response) const { done_(std::move(response)); }

 private:
  const v1::OptimizeTraverseRequest request_;
  const std::string client_;
  const OptimizeDone done_;
  std::stop_source ending_;
  Stop stop_;
  std::optional<std::stop_callback<std::function<void()>>> on_cancel_;
  std::optional<std::stop_callback<std::function<void()>>> on_close_;
};

// Used by one thread at a time.
class OptimizationRequests {
 public:
  // QUEUE_FULL with a RetryInfo: too many wait already.
  absl::Status Add(std::shared_ptr<OptimizationRequest> request);
  bool empty() const { return waiting_.empty(); }
  // The one that has waited longest. Precondition: not empty.
  std::shared_ptr<OptimizationRequest> TakeNext();
  std::deque<std::shared_ptr<OptimizationRequest>> TakeAll();

 private:
  std::deque<std::shared_ptr<OptimizationRequest>> waiting_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_TRACKING_OPTIMIZATION_REQUESTS_H_
