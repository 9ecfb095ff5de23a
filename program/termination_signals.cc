// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "program/termination_signals.h"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>

namespace curvereg {
namespace {

constexpr int kEndOfWatch = SIGUSR1;  // from our own destructor

sigset_t WatchedSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, kEndOfWatch);
  return signals;
}

void Watch(const std::stop_token& finished, std::stop_source requested, const std::string& second_signal_message) {
  using Clock = std::chrono::steady_clock;
  constexpr auto kOneRequest = std::chrono::milliseconds(500);  // timeout(1) and shells deliver one request twice
  const sigset_t signals = WatchedSignals();
  Clock::time_point first_request;
  int signal = 0;
  while (sigwait(&signals, &signal) == 0 && !finished.stop_requested()) {
    if (signal == kEndOfWatch) continue;
    if (requested.request_stop()) {
      first_request = Clock::now();
    } else if (Clock::now() - first_request > kOneRequest) {
      static_cast<void>(!write(STDERR_FILENO, second_signal_message.data(), second_signal_message.size()));
      _exit(1);
    }
  }
}

}  // namespace

TerminationSignals::TerminationSignals(std::string second_signal_message) {
  const sigset_t signals = WatchedSignals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  thread_ = std::jthread(Watch, requested_, std::move(second_signal_message));
}

TerminationSignals::~TerminationSignals() {
  thread_.request_stop();
  pthread_kill(thread_.native_handle(), kEndOfWatch);
}

void TerminationSignals::Wait() const {
  std::mutex mutex;
  std::unique_lock lock(mutex);
  std::condition_variable_any woken;
  woken.wait(lock, requested_.get_token(), [] { return false; });
}

}  // namespace curvereg
