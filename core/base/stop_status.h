// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What work answers that a Stop ends without a result.
#ifndef CURVEREG_CORE_BASE_STOP_STATUS_H_
#define CURVEREG_CORE_BASE_STOP_STATUS_H_

#include <string>

#include "absl/status/status.h"
#include "core/base/stop.h"

namespace curvereg {

// OK, or why `what`, as in "the map", must end: CANCELLED, DEADLINE_EXCEEDED.
inline absl::Status StopStatus(const Stop& stop, const char* what) {
  if (stop.Cancelled()) return absl::CancelledError(std::string(what) + " was cancelled");
  if (stop.PastDeadline()) return absl::DeadlineExceededError(std::string(what) + " ran out of time");
  return absl::OkStatus();
}

}  // namespace curvereg

#endif  // CURVEREG_CORE_BASE_STOP_STATUS_H_
