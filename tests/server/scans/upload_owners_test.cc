// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/scans/upload_owners.h"

#include <atomic>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/testing/matchers.h"

namespace curvereg::server {
namespace {

using testing::IsOk;

absl::Status Begin() { return absl::OkStatus(); }

TEST(UploadOwners, TheStreamThatHadTheUploadIsStopped) {
  UploadOwners owners;
  const std::stop_source first;
  const std::stop_source second;
  ASSERT_THAT(owners.TakeOver("a", first, Begin), IsOk());
  EXPECT_FALSE(first.stop_requested());
  ASSERT_THAT(owners.TakeOver("a", second, Begin), IsOk());
  EXPECT_TRUE(first.stop_requested());
  EXPECT_FALSE(second.stop_requested());
}

TEST(UploadOwners, AnotherUploadIsNoTakeover) {
  UploadOwners owners;
  const std::stop_source first;
  ASSERT_THAT(owners.TakeOver("a", first, Begin), IsOk());
  ASSERT_THAT(owners.TakeOver("b", std::stop_source(), Begin), IsOk());
  EXPECT_FALSE(first.stop_requested());
}

TEST(UploadOwners, AFailedBeginTakesNothing) {
  UploadOwners owners;
  const std::stop_source first;
  const std::stop_source second;
  ASSERT_THAT(owners.TakeOver("a", first, Begin), IsOk());
  const absl::Status failed = owners.TakeOver("a", second, [] { return absl::DataLossError("disk"); });
  EXPECT_EQ(failed, absl::DataLossError("disk"));
  EXPECT_FALSE(first.stop_requested());
  ASSERT_THAT(owners.TakeOver("a", std::stop_source(), Begin), IsOk());
  EXPECT_TRUE(first.stop_requested()) << "it still had the upload";
  EXPECT_FALSE(second.stop_requested());
}

TEST(UploadOwners, OnlyTheOwnerCanRelease) {
  UploadOwners owners;
  const std::stop_source first;
  const std::stop_source second;
  ASSERT_THAT(owners.TakeOver("a", first, Begin), IsOk());
  ASSERT_THAT(owners.TakeOver("a", second, Begin), IsOk());
  owners.Release("a", first);  // comes too late
  ASSERT_THAT(owners.TakeOver("a", std::stop_source(), Begin), IsOk());
  EXPECT_TRUE(second.stop_requested());
}

TEST(UploadOwners, AReleasedUploadHasNoOwnerToStop) {
  UploadOwners owners;
  const std::stop_source first;
  ASSERT_THAT(owners.TakeOver("a", first, Begin), IsOk());
  owners.Release("a", first);
  ASSERT_THAT(owners.TakeOver("a", std::stop_source(), Begin), IsOk());
  EXPECT_FALSE(first.stop_requested());
}

TEST(UploadOwners, OneBeginsAtATime) {
  UploadOwners owners;
  std::atomic<int> num_beginning = 0;
  std::atomic<int> most_at_once = 0;
  std::vector<std::stop_source> sources(8);
  {
    std::vector<std::jthread> streams;
    for (const std::stop_source& source : sources) {
      streams.emplace_back([&] {
        ASSERT_THAT(owners.TakeOver("a", source,
                                    [&] {
                                      most_at_once = std::max<int>(most_at_once, ++num_beginning);
                                      std::this_thread::sleep_for(std::chrono::milliseconds(2));
                                      --num_beginning;
                                      return absl::OkStatus();
                                    }),
                    IsOk());
      });
    }
  }
  EXPECT_EQ(most_at_once, 1);
  int num_stopped = 0;
  for (const std::stop_source& source : sources) num_stopped += source.stop_requested() ? 1 : 0;
  EXPECT_EQ(num_stopped, 7) << "all but the last";
}

}  // namespace
}  // namespace curvereg::server
