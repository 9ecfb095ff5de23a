// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/tracking/optimization_requests.h"

#include <chrono>
#include <cstddef>
#include <utility>

#include "wire/error.h"

namespace curvereg::server {
namespace {

constexpr std::size_t kMaxWaiting = 16;

}  // namespace

OptimizationRequest::OptimizationRequest(const v1::OptimizeTraverseRequest& asked_for, std::string of_client,
                                         const Stop& of_caller, OptimizeDone when_done)
    : request_(asked_for), client_(std::move(of_client)), done_(std::move(when_done)), stop_(of_caller) {
  stop_.cancellation = ending_.get_token();
}

void OptimizationRequest::StopWith(const std::stop_token& caller, const std::stop_token& closing) {
  on_cancel_.emplace(caller, [this] { ending_.request_stop(); });
  on_close_.emplace(closing, [this] { ending_.request_stop(); });
}

absl::Status OptimizationRequests::Add(std::shared_ptr<OptimizationRequest> request) {
  if (waiting_.size() >= kMaxWaiting) {
    return wire::WithRetryDelay(
        wire::MakeError(v1::ERROR_REASON_QUEUE_FULL, "too many optimisations of the traverse wait already"),
        std::chrono::seconds(1));
  }
  waiting_.push_back(std::move(request));
  return absl::OkStatus();
}

std::shared_ptr<OptimizationRequest> OptimizationRequests::TakeNext() {
  std::shared_ptr<OptimizationRequest> next = std::move(waiting_.front());
  waiting_.pop_front();
  return next;
}

std::deque<std::shared_ptr<OptimizationRequest>> OptimizationRequests::TakeAll() { return std::exchange(waiting_, {}); }

}  // namespace curvereg::server
