// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <set>
#include <thread>
#include <vector>

namespace curvereg {
namespace {

TEST(ParallelForTest, CallsEachTaskOnceAtAnyThreadCount) {
  for (const int num_threads : {0, 1, 2, 4}) {
    std::vector<std::atomic<int>> calls(257);
    WithThreadLimit(num_threads, [&] { ParallelFor(257, [&](int i) { ++calls[static_cast<size_t>(i)]; }); });
    for (const auto& count : calls) EXPECT_EQ(count, 1);
  }
}

TEST(ParallelForTest, NestedLoopsFinish) {
  std::atomic<int> sum = 0;
  WithThreadLimit(2, [&] { ParallelFor(4, [&](int) { ParallelFor(8, [&](int j) { sum += j; }); }); });
  EXPECT_EQ(sum, 4 * 28);
}

TEST(ParallelForTest, StaysOnTheCallersThreadWithoutALimit) {
  std::set<std::thread::id> threads;
  ParallelFor(16, [&](int) { threads.insert(std::this_thread::get_id()); });
  EXPECT_EQ(threads, std::set<std::thread::id>{std::this_thread::get_id()});
}

TEST(ParallelForTest, NoTasksIsNoWork) {
  ParallelFor(0, [](int) { FAIL(); });
}

}  // namespace
}  // namespace curvereg
