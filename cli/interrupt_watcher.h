// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Turns SIGINT and SIGTERM into a stop token: a signal handler may call almost nothing, a thread may.
#ifndef CURVEREG_CLI_INTERRUPT_WATCHER_H_
#define CURVEREG_CLI_INTERRUPT_WATCHER_H_

#include <stop_token>
#include <thread>

namespace curvereg::cli {

// Construct before any other thread exists: the signals are blocked in this thread and those it starts later.
// The first signal requests the stop; the second ends the process at once with status 1.
class InterruptWatcher {
 public:
  InterruptWatcher();
  ~InterruptWatcher();
  InterruptWatcher(const InterruptWatcher&) = delete;
  InterruptWatcher& operator=(const InterruptWatcher&) = delete;

  std::stop_token token() const { return interrupted_.get_token(); }

 private:
  std::stop_source interrupted_;
  std::jthread thread_;
};

}  // namespace curvereg::cli

#endif  // CURVEREG_CLI_INTERRUPT_WATCHER_H_
