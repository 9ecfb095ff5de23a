// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/preparation/traverse_scans.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/preparation/scan_sources.h"
#include "tests/server/store/store_testing.h"
#include "tests/testing/scenes.h"
#include "wire/error.h"
#include "wire/point_codec.h"

namespace curvereg::server {
namespace {

using testing::IsOk;

TEST(IsLastingTest, FaultsAndLackOfMemoryPass) {
  for (const v1::ErrorReason reason :
       {v1::ERROR_REASON_MEMORY_BUDGET, v1::ERROR_REASON_STORAGE_FAULT, v1::ERROR_REASON_STORAGE_FULL}) {
    EXPECT_FALSE(IsLasting(wire::MakeError(reason, "later"))) << wire::ReasonName(reason);
  }
  EXPECT_FALSE(IsLasting(absl::CancelledError("")));
  EXPECT_FALSE(IsLasting(absl::DeadlineExceededError("")));
  EXPECT_FALSE(IsLasting(absl::InternalError("")));
  EXPECT_FALSE(IsLasting(absl::OkStatus()));
}

TEST(IsLastingTest, WhatIsWrongWithTheScanLasts) {
  for (const v1::ErrorReason reason : {v1::ERROR_REASON_SCAN_NOT_FOUND, v1::ERROR_REASON_SCAN_TOO_LARGE,
                                       v1::ERROR_REASON_UNUSABLE_SCAN, v1::ERROR_REASON_STORED_SCAN_DAMAGED}) {
    EXPECT_TRUE(IsLasting(wire::MakeError(reason, "for ever"))) << wire::ReasonName(reason);
  }
}

class TraverseScansTest : public ::testing::Test {
 protected:
  std::string Keep(int num_points) {
    Scan scan;
    scan.points = testing::PatchPoints({.side_m = 10.0, .noise_m = 0.02}, num_points, 7);
    const v1::PointCloud cloud = *wire::EncodeScan(scan);
    const auto stored =
        Store(*store_, {"upload", cloud.header(), cloud.data().size(), DigestOf(cloud.data())}, cloud.data());
    EXPECT_THAT(stored, IsOk());
    return stored.ok() ? stored->scan.id : "";
  }

  testing::TemporaryFolder folder_;
  std::unique_ptr<ScanStore> store_ = OpenStore(folder_.path());
  MemoryBudget memory_{uint64_t{1} << 30};
  PreparedScanCache cache_{uint64_t{64} << 20};
  Metrics metrics_;
  const ScanSources sources_ = {
      .limits = {}, .memory = &memory_, .cache = &cache_, .store = store_.get(), .metrics = &metrics_};
};

TEST_F(TraverseScansTest, PreparesAScanOnce) {
  const std::string id = Keep(500);
  TraverseScans first(sources_);
  const auto scan = first.Load(id, {});
  ASSERT_THAT(scan, IsOk());
  EXPECT_EQ((*scan)->scan().points.size(), 500U);
  TraverseScans second(sources_);
  EXPECT_EQ(*second.Load(id, {}), *scan);
  EXPECT_EQ(cache_.GetStatistics().num_misses, 1U);
  EXPECT_EQ(memory_.reserved_bytes(), 0U);
}

TEST_F(TraverseScansTest, TellsTheCacheHowLargeItsScansHaveGrown) {
  const std::string id = Keep(500);
  std::shared_ptr<const PreparedScan> scan;
  {
    TraverseScans scans(sources_);
    scan = *scans.Load(id, {});
    ASSERT_THAT(scan->View(BirdsEyeView::kElevation, 0), IsOk());  // computed now
    EXPECT_LT(cache_.GetStatistics().bytes, scan->MemoryBytes());
  }
  EXPECT_EQ(cache_.GetStatistics().bytes, scan->MemoryBytes());
}

TEST_F(TraverseScansTest, ReservesMemoryWhileItPrepares) {
  const std::string id = Keep(500);
  const auto others = memory_.Reserve(memory_.total_bytes());
  ASSERT_THAT(others, IsOk());
  EXPECT_THAT(TraverseScans(sources_).Load(id, {}), HasReason(v1::ERROR_REASON_MEMORY_BUDGET));
}

TEST_F(TraverseScansTest, NamesWhatCannotBeUsed) {
  EXPECT_THAT(TraverseScans(sources_).Load(std::string(32, '0'), {}), HasReason(v1::ERROR_REASON_SCAN_NOT_FOUND));
  EXPECT_THAT(TraverseScans(sources_).Load(Keep(2), {}), HasReason(v1::ERROR_REASON_UNUSABLE_SCAN));
}

}  // namespace
}  // namespace curvereg::server
