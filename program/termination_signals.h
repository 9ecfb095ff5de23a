// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// SIGTERM and SIGINT as a stop token: a signal handler may call almost nothing, a thread may.
#ifndef CURVEREG_PROGRAM_TERMINATION_SIGNALS_H_
#define CURVEREG_PROGRAM_TERMINATION_SIGNALS_H_

#include <stop_token>
#include <string>
#include <thread>

namespace curvereg {

// Construct before any other thread exists: the signals are blocked in this thread and in those that it starts later.
// The first signal requests the stop. A second one, more than half a second later, writes `second_signal_message` to
// standard error and ends the process at once with status 1.
class TerminationSignals {
 public:
  explicit TerminationSignals(std::string second_signal_message);
  ~TerminationSignals();
  TerminationSignals(const TerminationSignals&) = delete;
  TerminationSignals& operator=(const TerminationSignals&) = delete;

  std::stop_token token() const { return requested_.get_token(); }
  void Wait() const;  // until the first signal

 private:
  std::stop_source requested_;
  std::jthread thread_;
};

}  // namespace curvereg

#endif  // CURVEREG_PROGRAM_TERMINATION_SIGNALS_H_
