// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/interrupt_watcher.h"

#include <pthread.h>
#include <signal.h>

#include <unistd.h>
#include <chrono>

namespace curvereg::cli {
namespace {

sigset_t WatchedSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGUSR1);  // from our own destructor
  return signals;
}

void Watch(std::stop_token finished, std::stop_source interrupted) {
  using Clock = std::chrono::steady_clock;
  constexpr auto kOneRequest = std::chrono::milliseconds(500);  // timeout(1) and shells deliver one request twice
  const sigset_t signals = WatchedSignals();
  Clock::time_point first_request;
  int signal = 0;
  while (sigwait(&signals, &signal) == 0 && !finished.stop_requested()) {
    if (signal == SIGUSR1) continue;
    if (interrupted.request_stop()) {
      first_request = Clock::now();
    } else if (Clock::now() - first_request > kOneRequest) {
      constexpr char kMessage[] = "curvereg: interrupted again, leaving at once\n";
      static_cast<void>(!write(STDERR_FILENO, kMessage, sizeof(kMessage) - 1));
      _exit(1);  // the user does not want to wait
    }
  }
}

}  // namespace

InterruptWatcher::InterruptWatcher() {
  const sigset_t signals = WatchedSignals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  thread_ = std::jthread(Watch, interrupted_);
}

InterruptWatcher::~InterruptWatcher() {
  thread_.request_stop();
  pthread_kill(thread_.native_handle(), SIGUSR1);
}

}  // namespace curvereg::cli
