// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/tracking/traverse_watchers.h"

#include <utility>

namespace curvereg::server {

class TraverseWatchers::Watcher final : public Subscription {
 public:
  Watcher(std::shared_ptr<TraverseWatchers> watchers, uint64_t number)
      : watchers_(std::move(watchers)), number_(number) {}
  ~Watcher() override {
    const std::lock_guard lock(watchers_->mutex_);
    watchers_->wakes_.erase(number_);
  }

 private:
  const std::shared_ptr<TraverseWatchers> watchers_;
  const uint64_t number_;
};

std::unique_ptr<Subscription> TraverseWatchers::Add(std::function<void()> wake) {
  const std::lock_guard lock(mutex_);
  wakes_.emplace(next_, std::move(wake));
  return std::make_unique<Watcher>(shared_from_this(), next_++);
}

void TraverseWatchers::Wake() {
  const std::lock_guard lock(mutex_);
  for (const auto& [number, wake] : wakes_) wake();
}

}  // namespace curvereg::server
