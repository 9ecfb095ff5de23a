// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A store that is full: by its limits, and because the disk is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "server/store/scan_store.h"
#include "tests/server/store/small_disk.h"
#include "tests/server/store/store_testing.h"

namespace curvereg::server {
namespace {

using ::testing::IsEmpty;
using testing::IsOk;

TEST(StoreLimitsTest, DeclaredBytesMustFit) {
  testing::TemporaryFolder folder;
  ScanStoreOptions options;
  options.max_stored_bytes = 10'000;
  std::unique_ptr<ScanStore> store = OpenStore(folder.path(), options);
  const std::string first = RandomBytes(6'000, 1);
  const std::string second = RandomBytes(4'001, 2);
  const std::string third = RandomBytes(4'000, 3);
  {
    // What an unfinished upload declares is set aside for it, come or not.
    const auto writer = store->BeginUpload(Describe("first", first));
    ASSERT_THAT(writer, IsOk());
    EXPECT_THAT(store->BeginUpload(Describe("second", second)), HasReason(v1::ERROR_REASON_STORAGE_FULL));
    ASSERT_THAT((*writer)->Discard(), IsOk());
  }
  const std::string id = Store(*store, Describe("first", first), first)->scan.id;
  EXPECT_THAT(store->BeginUpload(Describe("second", second)), HasReason(v1::ERROR_REASON_STORAGE_FULL));
  EXPECT_THAT(store->GetUpload("second"), HasReason(v1::ERROR_REASON_UPLOAD_NOT_FOUND));
  ASSERT_THAT(Store(*store, Describe("third", third), third), IsOk());
  EXPECT_THAT(store->BeginUpload(Describe("fourth", "x")), HasReason(v1::ERROR_REASON_STORAGE_FULL));
  UploadDescription huge = Describe("huge", "x");
  huge.payload_bytes = ~uint64_t{0};
  EXPECT_THAT(store->BeginUpload(huge), HasReason(v1::ERROR_REASON_STORAGE_FULL));
  // What is stored counts after a restart, too; what is deleted makes room.
  store.reset();
  store = OpenStore(folder.path(), options);
  EXPECT_THAT(store->BeginUpload(Describe("fourth", "x")), HasReason(v1::ERROR_REASON_STORAGE_FULL));
  ASSERT_THAT(store->DeleteScan(id), IsOk());
  EXPECT_THAT(Store(*store, Describe("second", second), second), IsOk());
}

TEST(StoreLimitsTest, AnUploadLargerThanTheDiskIsRefusedAtOnce) {
  testing::TemporaryFolder folder;
  ScanStoreOptions options;
  options.max_stored_bytes = ~uint64_t{0};
  const std::unique_ptr<ScanStore> store = OpenStore(folder.path(), options);
  UploadDescription huge = Describe("huge", "x");
  huge.payload_bytes = uint64_t{1} << 60;
  EXPECT_THAT(store->BeginUpload(huge), HasReason(v1::ERROR_REASON_STORAGE_FULL));
}

TEST(StoreLimitsTest, UploadsAreCounted) {
  testing::TemporaryFolder folder;
  ScanStoreOptions options;
  options.max_uploads = 2;
  const std::unique_ptr<ScanStore> store = OpenStore(folder.path(), options);
  ASSERT_THAT(store->BeginUpload(Describe("a", "x")), IsOk());
  ASSERT_THAT(store->BeginUpload(Describe("b", "x")), IsOk());
  const absl::Status status = store->BeginUpload(Describe("c", "x")).status();
  EXPECT_THAT(status, HasReason(v1::ERROR_REASON_TOO_MANY_UPLOADS));
  EXPECT_TRUE(wire::RetryDelayOf(status).has_value());
  ASSERT_THAT(store->BeginUpload(Describe("a", "x")), IsOk()) << "resuming is no new upload";
  ASSERT_THAT(Store(*store, Describe("a", "x"), "x"), IsOk());
  EXPECT_THAT(store->BeginUpload(Describe("c", "x")), IsOk());
}

class FullDiskTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (const std::string problem = disk_.Mount(); !problem.empty()) GTEST_SKIP() << problem;
    store_ = OpenStore(disk_.File("data"));
    ASSERT_NE(store_, nullptr);
  }

  testing::SmallDisk disk_{"32m"};
  std::unique_ptr<ScanStore> store_;
};

TEST_F(FullDiskTest, AppendKeepsWhatWasCommitted) {
  const std::string payload = RandomBytes(1'000'000, 1);
  const std::string_view bytes = payload;
  const auto writer = store_->BeginUpload(Describe("upload", payload)).value();
  ASSERT_THAT(writer->Append(0, bytes.substr(0, 300'000)), IsOk());
  disk_.FillUp(100'000);
  for (int i = 0; i < 3; ++i) {
    EXPECT_THAT(writer->Append(300'000, bytes.substr(300'000)), HasReason(v1::ERROR_REASON_STORAGE_FULL));
    EXPECT_EQ(writer->committed_offset(), 300'000U);
    EXPECT_EQ(std::filesystem::file_size(disk_.File("data/uploads/upload")), 300'000U);
  }
  EXPECT_THAT(store_->BeginUpload(Describe("other", payload)), HasReason(v1::ERROR_REASON_STORAGE_FULL));
  EXPECT_EQ(store_->GetUpload("upload")->committed_offset, 300'000U);
  EXPECT_EQ(store_->Statistics().stored_bytes, 300'000U);
  disk_.MakeRoom();
  ASSERT_THAT(writer->Append(300'000, bytes.substr(300'000)), IsOk());
  const auto committed = writer->Commit(0, "");
  ASSERT_THAT(committed, IsOk());
  EXPECT_EQ(store_->ReadWholePayload(committed->scan.id).value(), payload);
}

TEST_F(FullDiskTest, CommitKeepsTheUpload) {
  const std::string payload = RandomBytes(200'000, 1);
  const std::string other = RandomBytes(1'000, 2);
  const std::string id = Store(*store_, Describe("other", other), other)->scan.id;
  auto writer = store_->BeginUpload(Describe("upload", payload)).value();
  ASSERT_THAT(writer->Append(0, payload), IsOk());
  disk_.FillUp(0);
  // As long as the log finds no room there is no scan; what is there stays and can be read.
  absl::StatusOr<UploadWriter::Committed> committed = writer->Commit(0, "");
  ASSERT_THAT(committed, HasReason(v1::ERROR_REASON_STORAGE_FULL));
  EXPECT_EQ(store_->GetUpload("upload")->committed_offset, payload.size());
  EXPECT_EQ(store_->ReadWholePayload(id).value(), other);
  EXPECT_EQ(store_->Statistics().num_scans, 1U);
  writer.reset();
  store_.reset();
  store_ = OpenStore(disk_.File("data"));
  ASSERT_NE(store_, nullptr) << "a full disk must not keep a store from opening";
  EXPECT_EQ(store_->GetUpload("upload")->committed_offset, payload.size());
  EXPECT_EQ(store_->ReadWholePayload(id).value(), other);
  disk_.MakeRoom();
  committed = store_->BeginUpload(Describe("upload", payload)).value()->Commit(0, "");
  ASSERT_THAT(committed, IsOk());
  EXPECT_FALSE(committed->already_stored);
  EXPECT_EQ(store_->ReadWholePayload(committed->scan.id).value(), payload);
  EXPECT_THAT(store_->DamagedScans(), IsEmpty());
}

TEST_F(FullDiskTest, DeletingMakesRoom) {
  const std::string payload = RandomBytes(500'000, 1);
  const std::string id = Store(*store_, Describe("upload", payload), payload)->scan.id;
  disk_.FillUp(0);
  ASSERT_THAT(store_->DeleteScan(id), IsOk());
  EXPECT_GE(std::filesystem::space(disk_.path()).available, 400'000U);
  EXPECT_EQ(store_->Statistics().num_scans, 0U);
}

TEST_F(FullDiskTest, DiscardingMakesRoom) {
  const std::string payload = RandomBytes(500'000, 1);
  auto writer = store_->BeginUpload(Describe("upload", payload)).value();
  ASSERT_THAT(writer->Append(0, payload), IsOk());
  disk_.FillUp(0);
  ASSERT_THAT(writer->Discard(), IsOk());
  writer.reset();
  EXPECT_GE(std::filesystem::space(disk_.path()).available, 400'000U);
  EXPECT_EQ(store_->Statistics().num_uploads, 0U);
}

}  // namespace
}  // namespace curvereg::server
