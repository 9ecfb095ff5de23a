// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// SIGTERM and SIGINT as something to wait for: a signal handler may call almost nothing, a thread may.
#ifndef CURVEREG_PROGRAM_TERMINATION_SIGNALS_H_
#define CURVEREG_PROGRAM_TERMINATION_SIGNALS_H_

#include <stop_token>
#include <thread>

namespace curvereg::server {

// Construct before any other thread exists: the signals are blocked in this thread and those it starts later. SIGPIPE
// is ignored: a peer that went away is an error of the write. A second request ends the process at once, status 1.
class TerminationSignals {
 public:
  TerminationSignals();
  ~TerminationSignals();
  TerminationSignals(const TerminationSignals&) = delete;
  TerminationSignals& operator=(const TerminationSignals&) = delete;

  void Wait() const;  // until the first signal

 private:
  std::stop_source requested_;
  std::jthread thread_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_PROGRAM_TERMINATION_SIGNALS_H_
