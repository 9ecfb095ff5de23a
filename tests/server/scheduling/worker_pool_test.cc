// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/scheduling/worker_pool.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <latch>
#include <mutex>
#include <thread>
#include <vector>

#include "tests/testing/matchers.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using testing::IsOk;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using std::chrono::seconds;

MATCHER_P(HasReason, reason, "has the reason " + wire::ReasonName(reason)) {
  *result_listener << testing::StatusOf(arg);
  return wire::ReasonOf(testing::StatusOf(arg)) == reason;
}

// What tasks did, in order.
class Journal {
 public:
  void Add(const std::string& line) {
    const std::lock_guard<std::mutex> lock(mutex_);
    lines_.push_back(line);
  }
  std::vector<std::string> Lines() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return lines_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> lines_;
};

// Holds a worker until let go.
class Gate {
 public:
  WorkerPool::Task Task(const std::string& client = "gate") {
    return {.client = client,
            .cancellation = {},
            .run =
                [this](std::chrono::nanoseconds) {
                  entered_.count_down();
                  opened_.wait();
                },
            .drop = [](const absl::Status& status) { ADD_FAILURE() << "the gate was dropped: " << status; }};
  }
  void WaitUntilEntered() { entered_.wait(); }
  void Open() { opened_.count_down(); }

 private:
  std::latch entered_{1};
  std::latch opened_{1};
};

WorkerPool::Task Noting(Journal& journal, const std::string& client, const std::string& name,
                        std::stop_token cancellation = {}) {
  return {.client = client,
          .cancellation = std::move(cancellation),
          .run = [&journal, name](std::chrono::nanoseconds) { journal.Add(name); },
          .drop =
              [&journal, name](const absl::Status& status) {
                journal.Add(name + ": " + wire::ReasonName(*wire::ReasonOf(status)));
              }};
}

void Finish(WorkerPool& pool) { pool.Shutdown(Clock::now() + seconds(20)); }

TEST(WorkerPoolTest, ClientsTakeTurnsAndEachIsServedInOrder) {
  WorkerPool pool({.num_workers = 1});
  Gate gate;
  Journal journal;
  ASSERT_THAT(pool.Submit(gate.Task()), IsOk());
  gate.WaitUntilEntered();
  for (const char* name : {"flood 1", "flood 2", "flood 3", "flood 4"}) {
    ASSERT_THAT(pool.Submit(Noting(journal, "flood", name)), IsOk());
  }
  for (const char* name : {"a 1", "a 2"}) ASSERT_THAT(pool.Submit(Noting(journal, "a", name)), IsOk());
  ASSERT_THAT(pool.Submit(Noting(journal, "b", "b 1")), IsOk());
  EXPECT_EQ(pool.Statistics().num_waiting, 7);
  gate.Open();
  Finish(pool);
  EXPECT_THAT(journal.Lines(), ElementsAre("flood 1", "a 1", "b 1", "flood 2", "a 2", "flood 3", "flood 4"));
}

TEST(WorkerPoolTest, AFloodingClientIsRefusedAndOthersAreNot) {
  WorkerPool pool({.num_workers = 1, .max_queue_length = 4, .max_queue_per_client = 2});
  Gate gate;
  Journal journal;
  ASSERT_THAT(pool.Submit(gate.Task()), IsOk());
  gate.WaitUntilEntered();
  for (int i = 0; i < 2; ++i) ASSERT_THAT(pool.Submit(Noting(journal, "flood", "flood")), IsOk());
  const absl::Status flooded = pool.Submit(Noting(journal, "flood", "refused"));
  EXPECT_THAT(flooded, HasReason(v1::ERROR_REASON_CLIENT_QUOTA));
  ASSERT_TRUE(wire::RetryDelayOf(flooded).has_value());
  EXPECT_GE(*wire::RetryDelayOf(flooded), milliseconds(50));
  for (int i = 0; i < 2; ++i) ASSERT_THAT(pool.Submit(Noting(journal, "a", "a")), IsOk());
  const absl::Status full = pool.Submit(Noting(journal, "b", "refused"));
  EXPECT_THAT(full, HasReason(v1::ERROR_REASON_QUEUE_FULL));
  EXPECT_TRUE(wire::RetryDelayOf(full).has_value());
  gate.Open();
  Finish(pool);
  EXPECT_THAT(journal.Lines(), ElementsAre("flood", "a", "flood", "a"));
}

TEST(WorkerPoolTest, RetryDelayGrowsWithTheDurationOfTasks) {
  const auto delay_after_task_of = [](milliseconds duration) {
    WorkerPool pool({.num_workers = 1, .max_queue_length = 2});
    std::latch done(1);
    EXPECT_THAT(pool.Submit({.client = "a",
                             .cancellation = {},
                             .run = [duration](auto) { std::this_thread::sleep_for(duration); },
                             .drop = [](const auto&) {}}),
                IsOk());
    Gate gate;
    EXPECT_THAT(pool.Submit(gate.Task()), IsOk());
    gate.WaitUntilEntered();  // by then the first one is counted
    EXPECT_GE(pool.Statistics().mean_task_seconds, 1e-3 * static_cast<double>(duration.count()));
    Journal journal;
    for (int i = 0; i < 2; ++i) EXPECT_THAT(pool.Submit(Noting(journal, "a", "a")), IsOk());
    const auto delay = wire::RetryDelayOf(pool.Submit(Noting(journal, "a", "refused")));
    gate.Open();
    Finish(pool);  // its tasks write into the journal
    return delay.value_or(milliseconds(-1));
  };
  EXPECT_GE(delay_after_task_of(milliseconds(0)), milliseconds(50));
  EXPECT_GE(delay_after_task_of(milliseconds(200)), milliseconds(390));
}

TEST(WorkerPoolTest, ACancelledTaskLeavesTheQueueAtOnce) {
  WorkerPool pool({.num_workers = 1, .max_queue_length = 2});
  Gate gate;
  Journal journal;
  std::stop_source cancellation;
  ASSERT_THAT(pool.Submit(gate.Task()), IsOk());
  gate.WaitUntilEntered();
  ASSERT_THAT(pool.Submit(Noting(journal, "a", "first", cancellation.get_token())), IsOk());
  ASSERT_THAT(pool.Submit(Noting(journal, "a", "second")), IsOk());
  EXPECT_THAT(pool.Submit(Noting(journal, "b", "refused")), HasReason(v1::ERROR_REASON_QUEUE_FULL));
  cancellation.request_stop();
  EXPECT_THAT(journal.Lines(), ElementsAre("first: CANCELLED"));  // while the only worker is held
  EXPECT_EQ(pool.Statistics().num_waiting, 1);
  EXPECT_THAT(pool.Submit(Noting(journal, "b", "third")), IsOk());  // its place is free
  gate.Open();
  Finish(pool);
  EXPECT_THAT(journal.Lines(), ElementsAre("first: CANCELLED", "second", "third"));
}

TEST(WorkerPoolTest, ATaskCancelledBeforehandIsDropped) {
  WorkerPool pool({.num_workers = 1});
  Journal journal;
  std::stop_source cancellation;
  cancellation.request_stop();
  EXPECT_THAT(pool.Submit(Noting(journal, "a", "late", cancellation.get_token())), IsOk());
  EXPECT_THAT(journal.Lines(), ElementsAre("late: CANCELLED"));
  EXPECT_EQ(pool.Statistics().num_waiting, 0);
}

TEST(WorkerPoolTest, CancellingARunningTaskIsItsOwnBusiness) {
  WorkerPool pool({.num_workers = 1});
  std::stop_source cancellation;
  std::latch entered(1);
  std::atomic<bool> dropped = false;
  ASSERT_THAT(pool.Submit({.client = "a",
                           .cancellation = cancellation.get_token(),
                           .run =
                               [&, token = cancellation.get_token()](auto) {
                                 entered.count_down();
                                 while (!token.stop_requested()) std::this_thread::sleep_for(milliseconds(1));
                               },
                           .drop = [&](const auto&) { dropped = true; }}),
              IsOk());
  entered.wait();
  cancellation.request_stop();
  Finish(pool);
  EXPECT_FALSE(dropped);
}

TEST(WorkerPoolTest, TasksAreToldHowLongTheyWaited) {
  WorkerPool pool({.num_workers = 1});
  Gate gate;
  std::chrono::nanoseconds waited{-1};
  ASSERT_THAT(pool.Submit(gate.Task()), IsOk());
  gate.WaitUntilEntered();
  ASSERT_THAT(pool.Submit({.client = "a",
                           .cancellation = {},
                           .run = [&](std::chrono::nanoseconds duration) { waited = duration; },
                           .drop = [](const auto&) {}}),
              IsOk());
  std::this_thread::sleep_for(milliseconds(30));
  gate.Open();
  Finish(pool);
  EXPECT_GE(waited, milliseconds(30));
}

TEST(WorkerPoolTest, ShutdownLetsTheQueueFinishInTime) {
  WorkerPool pool({.num_workers = 2});
  Journal journal;
  for (int i = 0; i < 8; ++i) ASSERT_THAT(pool.Submit(Noting(journal, "a", "a")), IsOk());
  Finish(pool);
  EXPECT_EQ(journal.Lines(), std::vector<std::string>(8, "a"));
  EXPECT_THAT(pool.Submit(Noting(journal, "a", "late")), HasReason(v1::ERROR_REASON_NOT_SERVING));
  Finish(pool);  // again
  EXPECT_EQ(journal.Lines().size(), 8U);
}

TEST(WorkerPoolTest, ShutdownDropsWhatStillWaitsAndJoinsWhatRuns) {
  WorkerPool pool({.num_workers = 1});
  Gate gate;
  Journal journal;
  ASSERT_THAT(pool.Submit(gate.Task()), IsOk());
  gate.WaitUntilEntered();
  ASSERT_THAT(pool.Submit(Noting(journal, "a", "first")), IsOk());
  ASSERT_THAT(pool.Submit(Noting(journal, "b", "second")), IsOk());
  std::jthread opener([&] {
    while (journal.Lines().size() < 2) std::this_thread::sleep_for(milliseconds(1));
    gate.Open();
  });
  const Clock::time_point start = Clock::now();
  pool.Shutdown(start + milliseconds(50));
  EXPECT_GE(Clock::now() - start, milliseconds(50));
  EXPECT_THAT(journal.Lines(), ElementsAre("first: NOT_SERVING", "second: NOT_SERVING"));
  EXPECT_EQ(pool.Statistics().num_running, 0);
}

TEST(WorkerPoolTest, ADestroyedPoolDropsItsQueue) {
  Journal journal;
  Gate gate;
  std::jthread opener;
  {
    WorkerPool pool({.num_workers = 1});
    ASSERT_THAT(pool.Submit(gate.Task()), IsOk());
    gate.WaitUntilEntered();
    ASSERT_THAT(pool.Submit(Noting(journal, "a", "first")), IsOk());
    opener = std::jthread([&] {
      while (journal.Lines().empty()) std::this_thread::sleep_for(milliseconds(1));
      gate.Open();
    });
  }
  EXPECT_THAT(journal.Lines(), ElementsAre("first: NOT_SERVING"));
}

TEST(WorkerPoolTest, RunsAsManyAtOnceAsItHasWorkers) {
  WorkerPool pool({.num_workers = 3});
  EXPECT_EQ(pool.Statistics().num_workers, 3);
  Gate gates[3];
  for (Gate& gate : gates) ASSERT_THAT(pool.Submit(gate.Task()), IsOk());
  for (Gate& gate : gates) gate.WaitUntilEntered();  // all at once, of one client
  EXPECT_EQ(pool.Statistics().num_running, 3);
  for (Gate& gate : gates) gate.Open();
  Finish(pool);
  EXPECT_GT(WorkerPool(WorkerPoolOptions{}).Statistics().num_workers, 0);
}

TEST(WorkerPoolTest, ATaskMaySubmitAnother) {
  WorkerPool pool({.num_workers = 1});
  Journal journal;
  std::latch done(1);
  ASSERT_THAT(pool.Submit({.client = "a",
                           .cancellation = {},
                           .run =
                               [&](auto) {
                                 EXPECT_THAT(pool.Submit(Noting(journal, "a", "inner")), IsOk());
                                 done.count_down();
                               },
                           .drop = [](const auto&) {}}),
              IsOk());
  done.wait();
  Finish(pool);
  EXPECT_THAT(journal.Lines(), ElementsAre("inner"));
}

// Submitting, running, cancelling and shutting down at once: each accepted task ends exactly once, no refused one does.
TEST(WorkerPoolTest, EveryTaskEndsOnceWhateverHappensAtOnce) {
  constexpr int kNumThreads = 4;
  constexpr int kTasksPerThread = 500;
  WorkerPool pool({.num_workers = 2, .max_queue_length = 20, .max_queue_per_client = 8});
  std::vector<std::atomic<int>> ends(kNumThreads * kTasksPerThread);
  std::vector<int> accepted(kNumThreads * kTasksPerThread, 0);
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < kNumThreads; ++t) {
      threads.emplace_back([&, t] {
        std::stop_source previous;
        for (int i = 0; i < kTasksPerThread; ++i) {
          std::stop_source cancellation;
          std::atomic<int>& end = ends[static_cast<size_t>(t * kTasksPerThread + i)];
          const absl::Status status = pool.Submit({.client = std::to_string(t),
                                                   .cancellation = cancellation.get_token(),
                                                   .run = [&end](auto) { ++end; },
                                                   .drop = [&end](const auto&) { ++end; }});
          accepted[static_cast<size_t>(t * kTasksPerThread + i)] = status.ok() ? 1 : 0;
          if (i % 3 == 0) previous.request_stop();
          previous = cancellation;
        }
      });
    }
    threads.emplace_back([&] {
      std::this_thread::sleep_for(milliseconds(5));
      pool.Shutdown(Clock::now() + milliseconds(1));
    });
  }
  Finish(pool);
  int num_accepted = 0;
  for (size_t i = 0; i < ends.size(); ++i) {
    EXPECT_EQ(ends[i], accepted[i]) << i;
    num_accepted += accepted[i];
  }
  EXPECT_GT(num_accepted, 0);
  EXPECT_EQ(pool.Statistics().num_waiting, 0);
}

}  // namespace
}  // namespace curvereg::server
