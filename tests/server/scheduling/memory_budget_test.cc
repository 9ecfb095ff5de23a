// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Reservations, and that what is reserved for a registration or for pictures is enough: the peak of each is measured in
// a child process of its own.
#include "server/scheduling/memory_budget.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <functional>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "core/base/parallel.h"
#include "core/register_scans.h"
#include "render/scan_pictures.h"
#include "tests/testing/matchers.h"
#include "tests/testing/scenes.h"
#include "tests/testing/simulated.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

using testing::IsOk;

constexpr double kMegabyte = 1024.0 * 1024.0;

TEST(MemoryBudgetTest, GivesOutWhatThereIsAndTakesItBack) {
  MemoryBudget budget(100);
  {
    const auto first = budget.Reserve(60);
    ASSERT_THAT(first, IsOk());
    EXPECT_EQ(first->bytes(), 60U);
    const auto second = budget.Reserve(41);
    EXPECT_EQ(wire::ReasonOf(second.status()), v1::ERROR_REASON_MEMORY_BUDGET);
    EXPECT_TRUE(wire::RetryDelayOf(second.status()).has_value());
    EXPECT_THAT(budget.Reserve(40), IsOk());
    EXPECT_EQ(budget.reserved_bytes(), 60U);
  }
  EXPECT_EQ(budget.reserved_bytes(), 0U);
}

TEST(MemoryBudgetTest, WhatNeverFitsIsTooLarge) {
  MemoryBudget budget(100);
  for (const uint64_t bytes : {uint64_t{101}, std::numeric_limits<uint64_t>::max()}) {
    const auto refused = budget.Reserve(bytes);
    EXPECT_EQ(wire::ReasonOf(refused.status()), v1::ERROR_REASON_SCAN_TOO_LARGE);
    EXPECT_FALSE(wire::RetryDelayOf(refused.status()).has_value());
  }
}

TEST(MemoryBudgetTest, MovedReservationsCountOnce) {
  MemoryBudget budget(100);
  MemoryBudget::Reservation kept;
  {
    auto reservation = budget.Reserve(10);
    ASSERT_THAT(reservation, IsOk());
    kept = *std::move(reservation);
  }
  EXPECT_EQ(budget.reserved_bytes(), 10U);
  kept = MemoryBudget::Reservation();
  EXPECT_EQ(budget.reserved_bytes(), 0U);
}

TEST(MemoryBudgetTest, NeverGivesOutMoreThanItHasToManyAtOnce) {
  MemoryBudget budget(50);
  std::atomic<bool> exceeded = false;
  {
    std::vector<std::jthread> threads;
    for (uint64_t t = 1; t <= 4; ++t) {
      threads.emplace_back([&, t] {
        for (int i = 0; i < 2000; ++i) {
          const auto reservation = budget.Reserve(7 * t);
          if (budget.reserved_bytes() > 50) exceeded = true;
        }
      });
    }
  }
  EXPECT_FALSE(exceeded);
  EXPECT_EQ(budget.reserved_bytes(), 0U);
}

// A line of /proc/self/status, e.g. "VmHWM", in bytes; -1 when there is none.
double StatusBytes(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    if (word != name + ":") continue;
    double kilobytes = -1.0;
    status >> kilobytes;
    return 1024.0 * kilobytes;
  }
  return -1.0;
}

// Bytes above what the process held before; -1: it failed. A child inherits only the thread that forks.
double PeakOf(const std::function<bool()>& work) {
  std::array<int, 2> pipe_ends = {};
  if (pipe(pipe_ends.data()) != 0) return -1.0;
  malloc_trim(0);  // memory that is kept but unused would hide as much of the peak
  const pid_t child = fork();
  if (child == 0) {
    const double before = StatusBytes("VmRSS");
    const double peak = work() ? StatusBytes("VmHWM") - before : -1.0;
    _exit(write(pipe_ends[1], &peak, sizeof(peak)) == sizeof(peak) ? 0 : 1);
  }
  close(pipe_ends[1]);
  double peak = -1.0;
  if (read(pipe_ends[0], &peak, sizeof(peak)) != sizeof(peak)) peak = -1.0;
  close(pipe_ends[0]);
  waitpid(child, nullptr, 0);
  return peak;
}

// Points all over a cube: every one in a cell of its own. The dearest scans there are.
Scan Scattered(size_t num_points, double half_side_m, uint64_t seed) {
  testing::Random random(seed);
  Scan scan;
  for (size_t i = 0; i < num_points; ++i) {
    scan.points.emplace_back(Eigen::Vector3d(random.Uniform(-half_side_m, half_side_m),
                                             random.Uniform(-half_side_m, half_side_m),
                                             random.Uniform(-half_side_m, half_side_m))
                                 .cast<float>());
  }
  return scan;
}

struct Case {
  std::string name;
  Scan source;
  Scan target;
};

std::vector<Case> Cases(size_t num_points) {
  const testing::ScanPairWithTruth yard = testing::PairOf("mars-yard-sim", 1, 0);
  return {{"mars-yard-sim", testing::Multiplied(yard.source, num_points), testing::Multiplied(yard.target, num_points)},
          {"scattered, 50 m", Scattered(num_points, 50.0, 1), Scattered(num_points, 50.0, 2)},
          {"scattered, 90 km", Scattered(num_points, 90e3, 1), Scattered(num_points, 90e3, 2)}};
}

void ExpectEnough(const std::string& name, double peak_bytes, double reserved_bytes) {
  std::printf("%-40s peak %7.1f MB, reserved %7.1f MB\n", name.c_str(), peak_bytes / kMegabyte,
              reserved_bytes / kMegabyte);
  std::fflush(stdout);
  EXPECT_GT(peak_bytes, 0.0) << name;
  EXPECT_LE(peak_bytes, 0.95 * reserved_bytes) << name;
}

class ReservedMemoryTest : public ::testing::TestWithParam<size_t> {
 protected:
  void SetUp() override {
#ifdef CURVEREG_SANITIZED
    GTEST_SKIP() << "sanitizers need memory of their own";
#endif
    if (StatusBytes("VmHWM") < 0.0) GTEST_SKIP() << "this system does not tell the peak memory of a process";
  }
};

TEST_P(ReservedMemoryTest, IsEnoughForRegistrations) {
  const auto reserved = 2.0 * static_cast<double>(PreparationBytes(GetParam()));
  for (const Case& scans : Cases(GetParam())) {
    for (const Method method : AllMethods()) {
      if (!IsAvailable(method)) continue;
      RegistrationOptions options;
      options.method = method;
      options.num_threads = 2;
      options.time_budget_s = 4.0;  // the baselines take minutes, and in the end up to 360 bytes a point
      const double peak = PeakOf([&] { return RegisterScans(scans.source, scans.target, options).ok(); });
      ExpectEnough(scans.name + ", " + std::string(MethodName(method)), peak, reserved);
    }
  }
}

TEST_P(ReservedMemoryTest, IsEnoughForPictures) {
  for (const Case& scans : Cases(GetParam())) {
    const double peak = PeakOf([&] {
      absl::StatusOr<ScanPictures> pictures = absl::UnknownError("not drawn");
      WithThreadLimit(2, [&] { pictures = DrawScan(scans.source); });
      std::vector<absl::StatusOr<std::string>> encoded;
      for (const NamedPicture& named : pictures->pictures) encoded.push_back(EncodePng(named.picture));
      return pictures.ok();
    });
    ExpectEnough(scans.name + ", pictures", peak, static_cast<double>(RenderingBytes(GetParam())));
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, ReservedMemoryTest, ::testing::Values(1000, 200'000),
                         [](const auto& size) { return std::to_string(size.param) + "Points"; });

}  // namespace
}  // namespace curvereg::server
