// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/preparation/prepared_scan_cache.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <latch>
#include <new>
#include <thread>
#include <vector>

#include "tests/testing/matchers.h"
#include "tests/testing/scenes.h"

namespace curvereg::server {
namespace {

using std::chrono::milliseconds;
using testing::HasCode;
using testing::IsOk;

constexpr uint64_t kPlenty = uint64_t{1} << 40;

// Prepares a small scan; the same each time.
absl::StatusOr<std::unique_ptr<const PreparedScan>> PrepareSmall() {
  auto scan = std::make_shared<Scan>();
  scan->points = testing::PatchPoints({.side_m = 10.0, .noise_m = 0.02}, 500, 7);
  return PreparedScan::Create(scan);
}

uint64_t SmallBytes() { return (*PrepareSmall())->MemoryBytes(); }

// Loads small scans and counts how often.
struct CountingLoader {
  std::atomic<int>* count;
  absl::StatusOr<std::unique_ptr<const PreparedScan>> operator()(const Stop&) const {
    ++*count;
    return PrepareSmall();
  }
};

TEST(PreparedScanCacheTest, LoadsOnceAndGivesTheSame) {
  PreparedScanCache cache(kPlenty);
  std::atomic<int> count = 0;
  const auto first = cache.Get("a", CountingLoader{&count}, {});
  const auto second = cache.Get("a", CountingLoader{&count}, {});
  ASSERT_THAT(first, IsOk());
  ASSERT_THAT(second, IsOk());
  EXPECT_EQ(*first, *second);
  EXPECT_EQ(count, 1);
  const auto statistics = cache.GetStatistics();
  EXPECT_EQ(statistics.num_hits, 1U);
  EXPECT_EQ(statistics.num_misses, 1U);
  EXPECT_EQ(statistics.num_entries, 1U);
  EXPECT_EQ(statistics.bytes, (*first)->MemoryBytes());
}

TEST(PreparedScanCacheTest, FindNeitherLoadsNorWaits) {
  PreparedScanCache cache(SmallBytes() * 5 / 2);
  EXPECT_EQ(cache.Find("a"), nullptr);
  EXPECT_EQ(cache.GetStatistics().num_misses, 0U);
  std::atomic<int> count = 0;
  const auto scan = cache.Get("a", CountingLoader{&count}, {});
  ASSERT_THAT(scan, IsOk());
  ASSERT_THAT(cache.Get("b", CountingLoader{&count}, {}), IsOk());
  EXPECT_EQ(cache.Find("a"), *scan);
  EXPECT_EQ(cache.GetStatistics().num_hits, 1U);
  ASSERT_THAT(cache.Get("c", CountingLoader{&count}, {}), IsOk());  // "b" goes: "a" was used since
  EXPECT_NE(cache.Find("a"), nullptr);
  EXPECT_EQ(cache.Find("b"), nullptr);
}

TEST(PreparedScanCacheTest, TheLeastRecentlyUsedGoesFirst) {
  PreparedScanCache cache(SmallBytes() * 5 / 2);  // holds two
  std::atomic<int> count = 0;
  for (const char* name : {"a", "b", "a", "c"}) ASSERT_THAT(cache.Get(name, CountingLoader{&count}, {}), IsOk());
  EXPECT_EQ(count, 3);
  EXPECT_EQ(cache.GetStatistics().num_evictions, 1U);
  ASSERT_THAT(cache.Get("a", CountingLoader{&count}, {}), IsOk());
  EXPECT_EQ(count, 3);  // "b" had to go
  ASSERT_THAT(cache.Get("b", CountingLoader{&count}, {}), IsOk());
  EXPECT_EQ(count, 4);
  EXPECT_EQ(cache.GetStatistics().num_entries, 2U);
  EXPECT_LE(cache.GetStatistics().bytes, SmallBytes() * 5 / 2);
}

TEST(PreparedScanCacheTest, WhatIsLargerThanTheBudgetIsGivenOutButNotKept) {
  PreparedScanCache cache(SmallBytes() - 1);
  std::atomic<int> count = 0;
  for (int i = 0; i < 2; ++i) {
    const auto scan = cache.Get("a", CountingLoader{&count}, {});
    ASSERT_THAT(scan, IsOk());
    EXPECT_EQ((*scan)->scan().points.size(), 500U);
  }
  EXPECT_EQ(count, 2);
  EXPECT_EQ(cache.GetStatistics().bytes, 0U);
  EXPECT_EQ(cache.GetStatistics().num_entries, 0U);
}

TEST(PreparedScanCacheTest, UseMakesEntriesGrowAndOthersLeave) {
  PreparedScanCache cache(SmallBytes() * 5 / 2);
  std::atomic<int> count = 0;
  ASSERT_THAT(cache.Get("a", CountingLoader{&count}, {}), IsOk());
  const auto b = cache.Get("b", CountingLoader{&count}, {});
  ASSERT_THAT(b, IsOk());
  ASSERT_THAT((*b)->View(BirdsEyeView::kElevation, 0), IsOk());  // more than a megabyte
  ASSERT_GT((*b)->MemoryBytes(), SmallBytes() * 5 / 2);
  cache.UpdateSize("b");
  EXPECT_EQ(cache.GetStatistics().num_entries, 1U);
  EXPECT_EQ(cache.GetStatistics().bytes, SmallBytes());
  cache.UpdateSize("b");  // nothing of that name
  cache.UpdateSize("never");
  ASSERT_THAT(cache.Get("a", CountingLoader{&count}, {}), IsOk());
  EXPECT_EQ(count, 2);
}

TEST(PreparedScanCacheTest, ErasedEntriesStayWithThoseWhoHoldThem) {
  PreparedScanCache cache(kPlenty);
  std::atomic<int> count = 0;
  const auto held = cache.Get("a", CountingLoader{&count}, {});
  ASSERT_THAT(held, IsOk());
  cache.Erase("a");
  cache.Erase("a");
  EXPECT_EQ(cache.GetStatistics().bytes, 0U);
  EXPECT_EQ((*held)->scan().points.size(), 500U);
  ASSERT_THAT(cache.Get("a", CountingLoader{&count}, {}), IsOk());
  EXPECT_EQ(count, 2);
}

TEST(PreparedScanCacheTest, WhatIsErasedWhileItLoadsIsNotKept) {
  PreparedScanCache cache(kPlenty);
  const auto scan = cache.Get("a",
                              [&](const Stop&) {
                                cache.Erase("a");
                                return PrepareSmall();
                              },
                              {});
  EXPECT_THAT(scan, IsOk());
  EXPECT_EQ(cache.GetStatistics().num_entries, 0U);
}

TEST(PreparedScanCacheTest, ErrorsAreGivenToTheCallerAndNotKept) {
  PreparedScanCache cache(kPlenty);
  const PreparedScanCache::Loader failing = [](const Stop&) { return absl::NotFoundError("no such scan"); };
  EXPECT_THAT(cache.Get("a", failing, {}), HasCode(absl::StatusCode::kNotFound));
  std::atomic<int> count = 0;
  EXPECT_THAT(cache.Get("a", CountingLoader{&count}, {}), IsOk());
}

// A loader that tells when it was entered and goes on when it is let.
struct Gate {
  std::latch entered{1};
  std::latch opened{1};
  PreparedScanCache::Loader Loader() {
    return [this](const Stop& stop) -> absl::StatusOr<std::unique_ptr<const PreparedScan>> {
      entered.count_down();
      opened.wait();
      if (stop.Cancelled()) return absl::CancelledError("stopped");
      return PrepareSmall();
    };
  }
};

PreparedScanCache::Loader Unexpected() {
  return [](const Stop&) -> absl::StatusOr<std::unique_ptr<const PreparedScan>> {
    ADD_FAILURE() << "loaded twice";
    return absl::InternalError("loaded twice");
  };
}

TEST(PreparedScanCacheTest, ThoseWhoAskAtOnceShareOneLoading) {
  PreparedScanCache cache(SmallBytes() - 1);  // even when it is not kept
  Gate gate;
  std::vector<std::shared_ptr<const PreparedScan>> scans(4);
  {
    std::vector<std::jthread> threads;
    threads.emplace_back([&] { scans[0] = *cache.Get("a", gate.Loader(), {}); });
    gate.entered.wait();
    for (size_t i = 1; i < scans.size(); ++i) {
      threads.emplace_back([&, i] { scans[i] = *cache.Get("a", Unexpected(), {}); });
    }
    std::this_thread::sleep_for(milliseconds(30));  // let them come to wait
    gate.opened.count_down();
  }
  for (const auto& scan : scans) EXPECT_EQ(scan, scans[0]);
  EXPECT_NE(scans[0], nullptr);
  EXPECT_EQ(cache.GetStatistics().num_misses, 1U);
  EXPECT_EQ(cache.GetStatistics().num_hits, 3U);
}

TEST(PreparedScanCacheTest, AnotherTakesOverWhenTheLoaderIsStopped) {
  PreparedScanCache cache(kPlenty);
  Gate gate;
  std::stop_source cancellation;
  std::atomic<int> count = 0;
  {
    std::jthread stopped([&] {
      EXPECT_THAT(cache.Get("a", gate.Loader(), Stop{cancellation.get_token(), {}}),
                  HasCode(absl::StatusCode::kCancelled));
    });
    gate.entered.wait();
    std::jthread other([&] { EXPECT_THAT(cache.Get("a", CountingLoader{&count}, {}), IsOk()); });
    std::this_thread::sleep_for(milliseconds(30));
    EXPECT_EQ(count, 0);
    cancellation.request_stop();
    gate.opened.count_down();
  }
  EXPECT_EQ(count, 1);
  EXPECT_EQ(cache.GetStatistics().num_entries, 1U);
}

TEST(PreparedScanCacheTest, WaitingEndsWhenTheOneWhoWaitsIsStopped) {
  PreparedScanCache cache(kPlenty);
  Gate gate;
  std::jthread loading([&] { EXPECT_THAT(cache.Get("a", gate.Loader(), {}), IsOk()); });
  gate.entered.wait();
  const Stop late{{}, std::chrono::steady_clock::now() + milliseconds(20)};
  EXPECT_THAT(cache.Get("a", Unexpected(), late), HasCode(absl::StatusCode::kDeadlineExceeded));
  std::stop_source cancellation;
  std::jthread waiting([&] {
    EXPECT_THAT(cache.Get("a", Unexpected(), Stop{cancellation.get_token(), {}}),
                HasCode(absl::StatusCode::kCancelled));
  });
  std::this_thread::sleep_for(milliseconds(20));
  cancellation.request_stop();
  waiting.join();
  gate.opened.count_down();
}

TEST(PreparedScanCacheTest, AnExceptionOfTheLoaderHoldsNobodyUp) {
  PreparedScanCache cache(kPlenty);
  const PreparedScanCache::Loader throwing = [](const Stop&) -> absl::StatusOr<std::unique_ptr<const PreparedScan>> {
    throw std::bad_alloc();
  };
  EXPECT_THROW((void)cache.Get("a", throwing, {}), std::bad_alloc);
  std::atomic<int> count = 0;
  EXPECT_THAT(cache.Get("a", CountingLoader{&count}, {}), IsOk());
}

TEST(PreparedScanCacheTest, ManyAtOnceStayWithinTheBudget) {
  const uint64_t max_bytes = SmallBytes() * 7 / 2;
  PreparedScanCache cache(max_bytes);
  std::atomic<int> count = 0;
  std::atomic<bool> exceeded = false;
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t) {
      threads.emplace_back([&, t] {
        for (int i = 0; i < 100; ++i) {
          const std::string name = std::to_string((i * (t + 3)) % 6);
          const auto scan = cache.Get(name, CountingLoader{&count}, {});
          if (!scan.ok() || (*scan)->scan().points.size() != 500) ADD_FAILURE() << scan.status();
          if (i % 7 == 0) cache.Erase(name);
          if (i % 5 == 0) cache.UpdateSize(name);
          if (cache.GetStatistics().bytes > max_bytes) exceeded = true;
        }
      });
    }
  }
  EXPECT_FALSE(exceeded);
  const auto statistics = cache.GetStatistics();
  EXPECT_EQ(statistics.num_misses, static_cast<uint64_t>(count.load()));
  EXPECT_EQ(statistics.num_hits + statistics.num_misses, 400U);
  EXPECT_EQ(statistics.bytes, statistics.num_entries * SmallBytes());
}

}  // namespace
}  // namespace curvereg::server
