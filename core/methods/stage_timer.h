// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Wall time of each stage of a registration, for the result's stage_times.
#ifndef CURVEREG_CORE_METHODS_STAGE_TIMER_H_
#define CURVEREG_CORE_METHODS_STAGE_TIMER_H_

#include <chrono>
#include <utility>
#include <vector>

#include "core/methods/registration_result.h"

namespace curvereg {

class StageTimer {
 public:
  // Books the time since the last lap (at first: since construction) on `stage`; a name met again adds to its entry.
  void Lap(const char* stage) {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - std::exchange(lap_start_, now)).count();
    for (StageTime& time : times_) {
      if (time.stage == stage) {
        time.seconds += seconds;
        return;
      }
    }
    times_.push_back({stage, seconds});
  }

  // The stages in order of their first lap; the timer is left empty.
  std::vector<StageTime> Take() { return std::exchange(times_, {}); }

 private:
  std::chrono::steady_clock::time_point lap_start_ = std::chrono::steady_clock::now();
  std::vector<StageTime> times_;
};

}  // namespace curvereg

#endif  // CURVEREG_CORE_METHODS_STAGE_TIMER_H_
