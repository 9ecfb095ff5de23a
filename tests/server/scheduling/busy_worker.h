// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#ifndef CURVEREG_TESTS_SERVER_SCHEDULING_BUSY_WORKER_H_
#define CURVEREG_TESTS_SERVER_SCHEDULING_BUSY_WORKER_H_

#include <chrono>
#include <latch>
#include <memory>

#include <gtest/gtest.h>

#include "server/scheduling/worker_pool.h"

namespace curvereg::testing {

// Keeps one worker of a pool busy until it is let go, at the latest with this.
class BusyWorker {
 public:
  explicit BusyWorker(server::WorkerPool& pool) {
    const absl::Status submitted = pool.Submit({.client = "other",
                                                .cancellation = {},
                                                .run =
                                                    [state = state_](std::chrono::nanoseconds) {
                                                      state->entered.count_down();
                                                      state->opened.wait();
                                                    },
                                                .drop = [](const absl::Status&) {}});
    EXPECT_TRUE(submitted.ok()) << submitted;
    if (submitted.ok()) state_->entered.wait();
  }
  ~BusyWorker() { LetGo(); }
  BusyWorker(const BusyWorker&) = delete;
  BusyWorker& operator=(const BusyWorker&) = delete;

  void LetGo() {
    if (!state_->opened.try_wait()) state_->opened.count_down();
  }

 private:
  struct State {
    std::latch entered{1};
    std::latch opened{1};
  };
  const std::shared_ptr<State> state_ = std::make_shared<State>();  // the task may see its end last
};

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_SERVER_SCHEDULING_BUSY_WORKER_H_
