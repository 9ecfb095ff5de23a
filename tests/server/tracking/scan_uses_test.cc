// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/tracking/scan_uses.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <thread>

#include "core/methods/prepared_scan.h"
#include "tests/server/tracking/tracking_world.h"
#include "wire/resource_names.h"

namespace curvereg::server {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using testing::IsOk;

class ScanUsesTest : public ::testing::Test {
 protected:
  // Makes the scan part of the traverse.
  void Use(const TraverseRecord& record, uint64_t sequence_number, const std::string& scan_id) {
    AcknowledgedScan scan;
    scan.header.set_sequence_number(sequence_number);
    scan.scan_id = scan_id;
    ASSERT_THAT(world_.store->AddScan(record, scan), IsOk());
  }
  // Puts something prepared into the cache under the scan's name.
  void Cache(const std::string& scan_id) {
    const auto load = [](const Stop&) {
      return PreparedScan::Create(
          std::make_shared<Scan>(*wire::DecodeScan(DriveCloud(0).header(), DriveCloud(0).data(), {})));
    };
    ASSERT_THAT(world_.cache.Get(wire::ScanName(scan_id), load, {}), IsOk());
  }
  bool IsStored(const std::string& scan_id) { return world_.scans->GetScan(scan_id).ok(); }

  TrackingWorld world_;
  const std::string scan_ = world_.Keep(DriveCloud(0));
};

TEST_F(ScanUsesTest, AScanThatNothingUsesIsDeletedFromStoreAndCache) {
  Cache(scan_);
  EXPECT_THAT(world_.uses->DeleteScan(scan_), IsOk());
  EXPECT_FALSE(IsStored(scan_));
  EXPECT_EQ(world_.cache.Find(wire::ScanName(scan_)), nullptr);
  EXPECT_THAT(world_.uses->DeleteScan(scan_), HasReason(v1::ERROR_REASON_SCAN_NOT_FOUND));
}

TEST_F(ScanUsesTest, AScanInUseStays) {
  Use(world_.AddTraverse("drive"), 0, scan_);
  Cache(scan_);
  EXPECT_THAT(world_.uses->DeleteScan(scan_), HasReason(v1::ERROR_REASON_SCAN_IN_USE));
  EXPECT_TRUE(IsStored(scan_));
  EXPECT_NE(world_.cache.Find(wire::ScanName(scan_)), nullptr);
}

TEST_F(ScanUsesTest, TheScansOfADeletedTraverseGoUnlessAnotherUsesThem) {
  const TraverseRecord gone = world_.AddTraverse("gone");
  const TraverseRecord other = world_.AddTraverse("other");
  const std::string shared = world_.Keep(DriveCloud(1));
  const std::string again = world_.Keep(DriveCloud(2));
  Use(gone, 0, scan_);
  Use(gone, 1, shared);
  Use(gone, 2, again);
  Use(other, 0, shared);
  Cache(scan_);
  world_.uses->DeletePending();
  EXPECT_TRUE(IsStored(scan_)) << "nothing is pending yet";
  ASSERT_THAT(world_.store->RemoveTraverse(gone.number), IsOk());
  Use(other, 1, again);  // before it is deleted
  EXPECT_THAT(*world_.store->PendingDeletions(), ElementsAre(scan_));
  world_.uses->DeletePending();
  EXPECT_FALSE(IsStored(scan_));
  EXPECT_EQ(world_.cache.Find(wire::ScanName(scan_)), nullptr);
  EXPECT_TRUE(IsStored(shared));
  EXPECT_TRUE(IsStored(again));
  EXPECT_THAT(*world_.store->PendingDeletions(), IsEmpty());
}

TEST_F(ScanUsesTest, APendingScanThatIsGoneAlreadyIsForgotten) {
  const TraverseRecord gone = world_.AddTraverse("gone");
  Use(gone, 0, scan_);
  ASSERT_THAT(world_.store->RemoveTraverse(gone.number), IsOk());
  ASSERT_THAT(world_.scans->DeleteScan(scan_), IsOk());
  world_.uses->DeletePending();
  EXPECT_THAT(*world_.store->PendingDeletions(), IsEmpty());
}

TEST_F(ScanUsesTest, TheLockKeepsScansWhileTheyBecomePartOfATraverse) {
  const TraverseRecord record = world_.AddTraverse("drive");
  std::unique_lock lock = world_.uses->Lock();
  absl::Status deleted;
  std::thread deletion([&] { deleted = world_.uses->DeleteScan(scan_); });
  Use(record, 0, scan_);
  lock.unlock();
  deletion.join();
  EXPECT_THAT(deleted, HasReason(v1::ERROR_REASON_SCAN_IN_USE));
}

}  // namespace
}  // namespace curvereg::server
