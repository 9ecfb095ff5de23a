// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/scheduling/delayed_calls.h"

#include <utility>

namespace curvereg::server {

DelayedCalls::DelayedCalls() : thread_([this](const std::stop_token& stop) { Run(stop); }) {}

void DelayedCalls::After(std::chrono::milliseconds delay, std::function<void()> function) {
  const std::lock_guard lock(mutex_);
  calls_.emplace(std::chrono::steady_clock::now() + delay, std::move(function));
  changed_.notify_all();
}

void DelayedCalls::Run(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    if (calls_.empty()) {
      changed_.wait(lock, stop, [&] { return !calls_.empty(); });
      continue;
    }
    const auto due = calls_.begin()->first;
    if (std::chrono::steady_clock::now() < due) {
      changed_.wait_until(lock, stop, due, [&] { return !calls_.empty() && calls_.begin()->first < due; });
      continue;
    }
    const std::function<void()> function = std::move(calls_.begin()->second);
    calls_.erase(calls_.begin());
    lock.unlock();
    function();
    lock.lock();
  }
}

}  // namespace curvereg::server
