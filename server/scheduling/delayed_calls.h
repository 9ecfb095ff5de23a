// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Things to be done a little later, by one thread.
#ifndef CURVEREG_SERVER_SCHEDULING_DELAYED_CALLS_H_
#define CURVEREG_SERVER_SCHEDULING_DELAYED_CALLS_H_

#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <thread>

namespace curvereg::server {

// Safe to use from several threads. Destroying it drops what is not due yet and waits for a call under way.
class DelayedCalls {
 public:
  DelayedCalls();
  // `function` is quick.
  void After(std::chrono::milliseconds delay, std::function<void()> function);

 private:
  void Run(const std::stop_token& stop);

  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::multimap<std::chrono::steady_clock::time_point, std::function<void()>> calls_;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_SCHEDULING_DELAYED_CALLS_H_
