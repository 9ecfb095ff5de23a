// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/preparation/scan_deletion.h"

#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/store/store_testing.h"
#include "tests/testing/scenes.h"
#include "wire/resource_names.h"

namespace curvereg::server {
namespace {

using testing::IsOk;

class DeleteStoredScanTest : public ::testing::Test {
 protected:
  void Cache(const std::string& scan_id) {
    const auto load = [](const Stop&) {
      const auto patch = testing::PatchPoints({.noise_m = 0.1}, 1000, 1);
      return PreparedScan::Create(std::make_shared<const Scan>(Scan{patch, {}}));
    };
    ASSERT_THAT(cache_.Get(wire::ScanName(scan_id), load, {}), IsOk());
    ASSERT_NE(cache_.Find(wire::ScanName(scan_id)), nullptr);
  }

  const testing::TemporaryFolder folder_;
  std::unique_ptr<ScanStore> store_ = OpenStore(folder_.path());
  PreparedScanCache cache_{uint64_t{64} << 20};
};

TEST_F(DeleteStoredScanTest, TakesTheScanFromStoreAndCache) {
  const std::string payload = RandomBytes(1000, 1);
  const auto kept = Store(*store_, Describe("a", payload), payload);
  ASSERT_THAT(kept, IsOk());
  const std::string other(32, '0');
  Cache(kept->scan.id);
  Cache(other);
  EXPECT_THAT(DeleteStoredScan(kept->scan.id, *store_, cache_), IsOk());
  EXPECT_THAT(store_->GetScan(kept->scan.id), HasReason(v1::ERROR_REASON_SCAN_NOT_FOUND));
  EXPECT_EQ(cache_.Find(wire::ScanName(kept->scan.id)), nullptr);
  EXPECT_NE(cache_.Find(wire::ScanName(other)), nullptr);
}

TEST_F(DeleteStoredScanTest, LeavesNothingInTheCacheOfAScanThatTheStoreHasNot) {
  const std::string gone(32, '1');
  Cache(gone);
  EXPECT_THAT(DeleteStoredScan(gone, *store_, cache_), HasReason(v1::ERROR_REASON_SCAN_NOT_FOUND));
  EXPECT_EQ(cache_.Find(wire::ScanName(gone)), nullptr);
}

}  // namespace
}  // namespace curvereg::server
