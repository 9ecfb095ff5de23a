// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "program/termination_signals.h"

#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <thread>

#include <gtest/gtest.h>

namespace curvereg {
namespace {

using std::chrono::milliseconds;

void AwaitStop(const TerminationSignals& signals) {
  for (int i = 0; i < 500 && !signals.token().stop_requested(); ++i) std::this_thread::sleep_for(milliseconds(10));
}

TEST(TerminationSignals, ASignalRequestsTheStop) {
  const TerminationSignals signals("");
  EXPECT_FALSE(signals.token().stop_requested());
  kill(getpid(), SIGINT);
  AwaitStop(signals);
  EXPECT_TRUE(signals.token().stop_requested());
}

TEST(TerminationSignals, WaitEndsWithTheFirstSignal) {
  const TerminationSignals signals("");
  const std::jthread sender([] {
    std::this_thread::sleep_for(milliseconds(50));
    kill(getpid(), SIGTERM);
  });
  signals.Wait();
  EXPECT_TRUE(signals.token().stop_requested());
}

TEST(TerminationSignals, OneRequestMayArriveTwice) {
  const TerminationSignals signals("second\n");
  kill(getpid(), SIGTERM);
  AwaitStop(signals);
  kill(getpid(), SIGTERM);
  std::this_thread::sleep_for(milliseconds(100));  // this process still runs then
  EXPECT_TRUE(signals.token().stop_requested());
}

// In a process of its own, which has no other threads.
TEST(TerminationSignalsDeathTest, ASecondRequestEndsTheProcessAtOnce) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto ask_twice = [] {
    const TerminationSignals signals("asked again\n");
    kill(getpid(), SIGINT);
    AwaitStop(signals);
    std::this_thread::sleep_for(milliseconds(700));
    kill(getpid(), SIGINT);
    std::this_thread::sleep_for(std::chrono::seconds(30));
    std::exit(0);
  };
  EXPECT_EXIT(ask_twice(), ::testing::ExitedWithCode(1), "asked again");
}

}  // namespace
}  // namespace curvereg
