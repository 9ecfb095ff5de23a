// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Cancelled at any moment, or out of time at any moment, a registration ends within 50 ms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <limits>
#include <thread>

#include "core/register_scans.h"
#include "tests/testing/matchers.h"
#include "tests/testing/patience.h"
#include "tests/testing/simulated.h"

namespace curvereg {
namespace {

using ::testing::Contains;
using testing::HasCode;
using testing::IsOk;
using testing::ScanPairWithTruth;
using Clock = std::chrono::steady_clock;

constexpr double kPromisedS = 0.05 * testing::kPatience;
// A machine busy with other work may hold any thread up; a loop that does not ask does so every time.
constexpr int kAttempts = 6;

double SecondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// Seconds from the request to the answer; negative when the answer came first.
double CancellationSeconds(const ScanPairWithTruth& pair, RegistrationOptions options, double request_s) {
  std::stop_source source;
  options.cancellation = source.get_token();
  Clock::time_point requested;
  const Clock::time_point start = Clock::now();
  std::jthread canceller([&] {
    std::this_thread::sleep_until(start + std::chrono::duration<double>(request_s));
    requested = Clock::now();
    source.request_stop();
  });
  const auto result = RegisterScans(pair.source, pair.target, options);
  const Clock::time_point answered = Clock::now();
  canceller.join();
  if (result.ok()) return -1.0;
  EXPECT_THAT(result, HasCode(absl::StatusCode::kCancelled));
  return std::chrono::duration<double>(answered - requested).count();
}

// The longest wait over all moments, each the shortest of some attempts.
double LongestCancellation(const ScanPairWithTruth& pair, const RegistrationOptions& options,
                           const std::vector<double>& moments_ms) {
  double longest = 0.0;
  for (const double moment_ms : moments_ms) {
    double shortest = std::numeric_limits<double>::infinity();
    for (int attempt = 0; attempt < kAttempts && shortest > 0.5 * kPromisedS; ++attempt) {
      shortest = std::min(shortest, CancellationSeconds(pair, options, 1e-3 * moment_ms));
    }
    std::printf("  requested at %6.1f ms: %s %.1f ms\n", moment_ms, shortest < 0.0 ? "answered before" : "ended after",
                1e3 * std::max(shortest, 0.0));
    EXPECT_LE(shortest, kPromisedS) << "requested after " << moment_ms << " ms";
    longest = std::max(longest, shortest);
  }
  return longest;
}

RegistrationOptions With(Method method) {
  RegistrationOptions options;
  options.method = method;
  options.num_threads = 2;
  return options;
}

constexpr std::initializer_list<double> kMoments = {0, 1, 2, 5, 10, 20, 35, 50, 75, 100, 150, 200, 300};

// Pairs without overlap run every escalation step, so that every stage is met.
TEST(StopTest, CancelledDuringEscalation) {
  for (const auto& [source, target] : {std::pair(4, 0), std::pair(2, 0)}) {
    const ScanPairWithTruth pair = testing::PairOf("negatives", source, target);
    std::printf("negatives %d -> %d\n", source, target);
    std::printf("longest %.1f ms\n", 1e3 * LongestCancellation(pair, With(Method::kCurvelet), kMoments));
  }
}

TEST(StopTest, CancelledWithManyFalseReturns) {
  const ScanPairWithTruth pair = testing::PairOf("outliers", 8, 4);
  std::printf("longest %.1f ms\n", 1e3 * LongestCancellation(pair, With(Method::kCurvelet), kMoments));
}

TEST(StopTest, CancelledWhileOtherMethodsRun) {
  const ScanPairWithTruth pair = testing::PairOf("mars-yard-sim", 1, 0);
  for (const Method method : {Method::kIcp, Method::kPaper}) {
    std::printf("%s\n", std::string(MethodName(method)).c_str());
    std::printf("longest %.1f ms\n", 1e3 * LongestCancellation(pair, With(method), kMoments));
  }
}

TEST(StopTest, CancelledOnTenMillionPoints) {
  const ScanPairWithTruth small = testing::PairOf("negatives", 4, 0);
  const ScanPairWithTruth pair{testing::Multiplied(small.source, 10'000'000),
                               testing::Multiplied(small.target, 10'000'000), small.T_target_source};
  const std::vector<double> moments = {0, 2, 10, 30, 60, 100, 200, 300, 400, 500, 700, 1000, 1500, 2000, 3000};
  std::printf("longest %.1f ms\n", 1e3 * LongestCancellation(pair, With(Method::kCurvelet), moments));
}

// Seconds by which the answer came after its budget. `whole`: the answer without one.
double Overrun(const ScanPairWithTruth& pair, RegistrationOptions options, double budget_s,
               const RegistrationResult& whole) {
  options.time_budget_s = budget_s;
  const Clock::time_point start = Clock::now();
  const auto result = RegisterScans(pair.source, pair.target, options);
  const double overrun_s = SecondsSince(start) - budget_s;
  EXPECT_THAT(result, IsOk());
  if (!result.ok()) return overrun_s;
  EXPECT_EQ(result->verdict.accepted, result->verdict.reasons.empty());
  // What was cut short says so.
  const bool is_cut =
      result->evidence.num_attempts < whole.evidence.num_attempts || result->verdict.accepted != whole.verdict.accepted;
  if (is_cut) {
    EXPECT_FALSE(result->verdict.accepted) << "budget " << budget_s;
    EXPECT_THAT(result->verdict.reasons, Contains(Reason::kDeadline).Times(1)) << "budget " << budget_s;
  }
  return overrun_s;
}

void ExpectWithinBudgets(const ScanPairWithTruth& pair, Method method, const std::vector<double>& budgets_ms) {
  const auto whole = RegisterScans(pair.source, pair.target, With(method));
  ASSERT_THAT(whole, IsOk());
  double longest = -std::numeric_limits<double>::infinity();
  for (const double budget_ms : budgets_ms) {
    double shortest = std::numeric_limits<double>::infinity();
    for (int attempt = 0; attempt < kAttempts && shortest > 0.5 * kPromisedS; ++attempt) {
      shortest = std::min(shortest, Overrun(pair, With(method), 1e-3 * budget_ms, *whole));
    }
    std::printf("  budget %7.3f ms: answered %.1f ms after\n", budget_ms, 1e3 * shortest);
    EXPECT_LE(shortest, kPromisedS) << "budget " << budget_ms << " ms";
    longest = std::max(longest, shortest);
  }
  std::printf("longest %.1f ms\n", 1e3 * longest);
}

constexpr std::initializer_list<double> kBudgets = {0.001, 0.1, 1, 2, 5, 10, 20, 35, 50, 100, 200, 400};

TEST(StopTest, AnswersInTimeOnNegativePairs) {
  ExpectWithinBudgets(testing::PairOf("negatives", 4, 0), Method::kCurvelet, kBudgets);
}

TEST(StopTest, AnswersInTimeWithEveryMethod) {
  const ScanPairWithTruth pair = testing::PairOf("mars-yard-sim", 1, 0);
  for (const Method method : {Method::kCurvelet, Method::kIcp, Method::kPaper}) {
    std::printf("%s\n", std::string(MethodName(method)).c_str());
    ExpectWithinBudgets(pair, method, kBudgets);
  }
}

TEST(StopTest, AGenerousBudgetChangesNothing) {
  const ScanPairWithTruth pair = testing::PairOf("mars-yard-sim", 1, 0);
  RegistrationOptions options = With(Method::kCurvelet);
  const auto without = RegisterScans(pair.source, pair.target, options);
  options.time_budget_s = 1e9;
  const auto with = RegisterScans(pair.source, pair.target, options);
  ASSERT_THAT(without, IsOk());
  ASSERT_THAT(with, IsOk());
  EXPECT_TRUE(with->verdict.accepted);
  EXPECT_EQ(with->T_target_source->matrix(), without->T_target_source->matrix());
}

TEST(StopTest, ThePoseOfACutAnswerIsTheBestSoFar) {
  const ScanPairWithTruth pair = testing::PairOf("mars-yard-sim", 1, 0);
  const auto whole = RegisterScans(pair.source, pair.target, With(Method::kCurvelet));
  ASSERT_THAT(whole, IsOk());
  for (const double share : {0.5, 0.6, 0.7, 0.8, 0.9}) {
    RegistrationOptions options = With(Method::kCurvelet);
    options.time_budget_s = share * whole->total_seconds;
    const auto cut = RegisterScans(pair.source, pair.target, options);
    ASSERT_THAT(cut, IsOk());
    if (!cut->T_target_source.has_value()) {
      EXPECT_THAT(cut->verdict.reasons, ::testing::ElementsAre(Reason::kDeadline));
      continue;
    }
    EXPECT_TRUE(IsRigid(*cut->T_target_source));
  }
}

}  // namespace
}  // namespace curvereg
