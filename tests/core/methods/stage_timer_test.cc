// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/methods/stage_timer.h"

#include <gtest/gtest.h>

#include <thread>

namespace curvereg {
namespace {

TEST(StageTimerTest, AddsUpPerStageInOrderOfFirstLap) {
  const auto start = std::chrono::steady_clock::now();
  StageTimer timer;
  std::this_thread::sleep_for(std::chrono::milliseconds(2));
  timer.Lap("features");
  timer.Lap("matching");
  std::this_thread::sleep_for(std::chrono::milliseconds(2));
  timer.Lap("features");
  const double total = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const std::vector<StageTime> times = timer.Take();
  ASSERT_EQ(times.size(), 2U);
  EXPECT_EQ(times[0].stage, "features");
  EXPECT_EQ(times[1].stage, "matching");
  EXPECT_GE(times[0].seconds, 0.004);
  EXPECT_GE(times[1].seconds, 0.0);
  EXPECT_LE(times[0].seconds + times[1].seconds, total);
  EXPECT_TRUE(timer.Take().empty());
}

}  // namespace
}  // namespace curvereg
