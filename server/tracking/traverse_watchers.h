// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Those who want to know when something happened in a traverse.
#ifndef CURVEREG_SERVER_TRACKING_TRAVERSE_WATCHERS_H_
#define CURVEREG_SERVER_TRACKING_TRAVERSE_WATCHERS_H_

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>

#include "server/tracking/traverse_types.h"

namespace curvereg::server {

// Outlives the traverse while somebody watches it. Safe to use from several threads.
class TraverseWatchers : public std::enable_shared_from_this<TraverseWatchers> {
 public:
  std::unique_ptr<Subscription> Add(std::function<void()> wake);
  void Wake();

 private:
  class Watcher;
  std::mutex mutex_;  // held during a wake, so that who leaves waits for it
  uint64_t next_ = 0;
  std::map<uint64_t, std::function<void()>> wakes_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_TRACKING_TRAVERSE_WATCHERS_H_
