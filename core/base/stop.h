// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// When a registration must end early: cancelled by the caller, or out of time. Passed down to every long loop,
// which asks at least every few milliseconds. The two differ in the answer: a cancelled call returns
// absl::CancelledError, a call out of time returns the best pose so far, marked with Reason::kDeadline.
#ifndef CURVEREG_CORE_BASE_STOP_H_
#define CURVEREG_CORE_BASE_STOP_H_

#include <chrono>
#include <optional>
#include <stop_token>

namespace curvereg {

struct Stop {
  std::stop_token cancellation;                                   // default: can never be cancelled
  std::optional<std::chrono::steady_clock::time_point> deadline;  // default: none

  bool Cancelled() const { return cancellation.stop_requested(); }
  bool PastDeadline() const { return deadline.has_value() && std::chrono::steady_clock::now() >= *deadline; }
  bool Requested() const { return Cancelled() || PastDeadline(); }
};

}  // namespace curvereg

#endif  // CURVEREG_CORE_BASE_STOP_H_
