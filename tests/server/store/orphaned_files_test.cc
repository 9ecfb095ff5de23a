// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Files that no row names: what a process that was killed leaves behind is removed, all else is kept.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "absl/strings/str_cat.h"
#include "server/store/scan_store.h"
#include "tests/server/store/store_testing.h"
#include "wire/digest.h"

namespace curvereg::server {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using testing::IsOk;
using ::testing::UnorderedElementsAre;

class OrphanedFilesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    store_ = OpenStore(folder_.path());
    id_ = Store(*store_, Describe("first", payload_), payload_)->scan.id;
  }
  void Reopen() {
    store_.reset();
    store_ = OpenStore(folder_.path());
    ASSERT_NE(store_, nullptr);
  }
  std::string PayloadPath(const std::string& payload) const {
    const std::string hex = wire::HexText(DigestOf(payload).value());
    return folder_.File("payloads/" + hex.substr(0, 2) + "/" + hex);
  }
  std::string RemovingPath(const std::string& payload) const {
    return folder_.File("removing/payload-" + wire::HexText(DigestOf(payload).value()));
  }
  void ForgetScan() { RunSql(folder_.File("curvereg.db"), "DELETE FROM scans"); }
  bool NothingIsLost() const { return !std::filesystem::exists(folder_.File("lost")); }

  const std::string payload_ = RandomBytes(100'000, 1);
  testing::TemporaryFolder folder_;
  std::unique_ptr<ScanStore> store_;
  std::string id_;
};

TEST_F(OrphanedFilesTest, FilesThatNoRowNamesAreSetAside) {
  const std::string digits(30, '0');
  const std::string orphan = "00" + digits;
  WriteFile(folder_.File("payloads/00/" + orphan), "orphan");
  WriteFile(folder_.File("payloads/00/notes.txt"), "not ours");
  WriteFile(folder_.File("uploads/orphan-1"), "bytes");
  Reopen();
  EXPECT_EQ(store_->Recovery().num_orphaned_files, 2U);
  EXPECT_EQ(ReadFile(folder_.File("lost/payload-" + orphan)), "orphan");
  EXPECT_EQ(ReadFile(folder_.File("lost/upload-orphan-1")), "bytes");
  EXPECT_THAT(FilesBelow(folder_.File("payloads")),
              UnorderedElementsAre(PayloadPath(payload_), folder_.File("payloads/00/notes.txt")));
  EXPECT_THAT(FilesBelow(folder_.File("uploads")), IsEmpty());
  EXPECT_EQ(store_->ReadWholePayload(id_).value(), payload_);
  EXPECT_EQ(store_->Statistics().stored_bytes, payload_.size());
  // Another of the same name replaces nothing.
  WriteFile(folder_.File("payloads/00/" + orphan), "another");
  Reopen();
  EXPECT_EQ(store_->Recovery().num_orphaned_files, 1U);
  EXPECT_EQ(ReadFile(folder_.File("lost/payload-" + orphan)), "orphan");
  EXPECT_EQ(ReadFile(folder_.File("lost/payload-" + orphan + ".2")), "another");
  Reopen();
  EXPECT_EQ(store_->Recovery().num_orphaned_files, 0U);
}

TEST_F(OrphanedFilesTest, AnInterruptedCommitStaysAnUpload) {
  const std::string other = RandomBytes(5'000, 2);
  {
    const auto writer = store_->BeginUpload(Describe("second", other));
    ASSERT_THAT(writer, IsOk());
    ASSERT_THAT((*writer)->Append(0, other), IsOk());
  }
  store_.reset();
  std::filesystem::create_directories(std::filesystem::path(PayloadPath(other)).parent_path());
  std::filesystem::create_hard_link(folder_.File("uploads/second"), PayloadPath(other));
  Reopen();
  EXPECT_TRUE(NothingIsLost());
  EXPECT_THAT(FilesBelow(folder_.File("payloads")), ElementsAre(PayloadPath(payload_)));
  EXPECT_EQ(store_->GetUpload("second")->committed_offset, other.size());
  ASSERT_THAT(Store(*store_, Describe("second", other), other), IsOk());
}

TEST_F(OrphanedFilesTest, ACommitInterruptedAtItsEndIsOne) {
  store_.reset();
  std::filesystem::create_hard_link(PayloadPath(payload_), folder_.File("uploads/first"));
  Reopen();
  EXPECT_TRUE(NothingIsLost());
  EXPECT_THAT(FilesBelow(folder_.File("uploads")), IsEmpty());
  EXPECT_EQ(store_->ReadWholePayload(id_).value(), payload_);
}

TEST_F(OrphanedFilesTest, AnInterruptedDeletionIsBroughtToItsEnd) {
  store_.reset();
  std::filesystem::create_directories(folder_.File("removing"));
  std::filesystem::create_hard_link(PayloadPath(payload_), RemovingPath(payload_));
  // Before the row goes nothing is deleted.
  Reopen();
  EXPECT_EQ(store_->ReadWholePayload(id_).value(), payload_);
  EXPECT_FALSE(std::filesystem::exists(RemovingPath(payload_)));
  store_.reset();
  std::filesystem::create_hard_link(PayloadPath(payload_), RemovingPath(payload_));
  ForgetScan();
  Reopen();
  EXPECT_TRUE(NothingIsLost());
  EXPECT_THAT(FilesBelow(folder_.File("payloads")), IsEmpty());
  EXPECT_THAT(FilesBelow(folder_.File("removing")), IsEmpty());
}

// The same bytes, but they came after the deletion.
TEST_F(OrphanedFilesTest, AnOldDeletionCostsNoNewPayload) {
  store_.reset();
  ForgetScan();
  WriteFile(RemovingPath(payload_), payload_);
  Reopen();
  EXPECT_EQ(store_->Recovery().num_orphaned_files, 1U);
  EXPECT_THAT(FilesBelow(folder_.File("payloads")), IsEmpty());
}

TEST_F(OrphanedFilesTest, ADeletionLeavesNothing) {
  ASSERT_THAT(store_->DeleteScan(id_), IsOk());
  EXPECT_THAT(FilesBelow(folder_.File("payloads")), IsEmpty());
  EXPECT_THAT(FilesBelow(folder_.File("removing")), IsEmpty());
}

TEST_F(OrphanedFilesTest, AnUploadThatWasDroppedLeavesNothing) {
  WriteFile(folder_.File("uploads/begun"), "");
  WriteFile(folder_.File("uploads/dropped"), "bytes");
  std::filesystem::create_directories(folder_.File("removing"));
  std::filesystem::create_hard_link(folder_.File("uploads/dropped"), folder_.File("removing/upload-dropped"));
  Reopen();
  EXPECT_TRUE(NothingIsLost());
  EXPECT_THAT(FilesBelow(folder_.File("uploads")), IsEmpty());
  EXPECT_THAT(FilesBelow(folder_.File("removing")), IsEmpty());
  // One whose file is the payload of a scan must not be emptied.
  std::string changed = payload_;
  changed.back() ^= 1;
  WriteFile(PayloadPath(payload_), changed);
  ASSERT_THAT(store_->CheckScan(id_), HasReason(v1::ERROR_REASON_STORED_SCAN_DAMAGED));
  ASSERT_THAT(Store(*store_, Describe("again", payload_), payload_), IsOk());
  EXPECT_THAT(FilesBelow(folder_.File("uploads")), IsEmpty());
  EXPECT_THAT(FilesBelow(folder_.File("removing")), IsEmpty());
  EXPECT_EQ(store_->ReadWholePayload(id_).value(), payload_);
}

TEST_F(OrphanedFilesTest, AnUploadWithoutItsBytesIsSaidSo) {
  const std::string other = RandomBytes(5'000, 2);
  for (const std::string id : {"gone", "there", "longer"}) {
    const auto writer = store_->BeginUpload(Describe(id, other));
    ASSERT_THAT(writer, IsOk());
    ASSERT_THAT((*writer)->Append(0, "some"), IsOk());
  }
  ASSERT_THAT(store_->BeginUpload(Describe("new", other)), IsOk());
  store_.reset();
  std::filesystem::remove(folder_.File("uploads/gone"));
  WriteFile(folder_.File("uploads/longer"), other + "x");
  Reopen();
  EXPECT_THAT(store_->Recovery().emptied_uploads, UnorderedElementsAre("gone", "longer"));
  EXPECT_EQ(store_->GetUpload("gone")->committed_offset, 0U);
  EXPECT_EQ(store_->GetUpload("there")->committed_offset, 4U);
  Reopen();
  EXPECT_THAT(store_->Recovery().emptied_uploads, IsEmpty());
}

// The write-ahead log of a process that was killed is damaged in some way.
class LostLogTest : public ::testing::Test {
 protected:
  // Three scans that the database has, three more scans and an upload that only its log has.
  void SetUp() override {
    std::unique_ptr<ScanStore> store;
    for (uint64_t i = 0; i < payloads_.size(); ++i) {
      if (i % 3 == 0) {
        store.reset();
        store = OpenStore(living_.path());
      }
      ASSERT_THAT(Store(*store, Describe(absl::StrCat("u", i), payloads_[i]), payloads_[i]), IsOk());
    }
    const auto writer = store->BeginUpload(Describe("half", payloads_[0]));
    ASSERT_THAT(writer, IsOk());
    ASSERT_THAT((*writer)->Append(0, std::string_view(payloads_[0]).substr(0, 500)), IsOk());
    // As the files are at this moment.
    std::filesystem::copy(living_.path(), dead_.path(), std::filesystem::copy_options::recursive);
    std::filesystem::remove(dead_.File("curvereg.db-shm"));
    ASSERT_GT(std::filesystem::file_size(log_), 10'000U);
  }

  // Every byte is either where it was or set aside, and if something is amiss it is said so.
  void ExpectNothingIsRemoved(uint64_t num_scans) {
    const std::unique_ptr<ScanStore> store = OpenStore(dead_.path());
    ASSERT_NE(store, nullptr);
    const std::vector<StoredScan> scans = store->ListScans(10, "")->scans;
    EXPECT_EQ(scans.size(), num_scans);
    uint64_t num_kept = 0;
    for (const std::string& payload : payloads_) {
      const std::string hex = wire::HexText(DigestOf(payload).value());
      const bool is_kept = ReadFile(dead_.File("payloads/" + hex.substr(0, 2) + "/" + hex)) == payload;
      const bool is_lost = !is_kept && ReadFile(dead_.File("lost/payload-" + hex)) == payload;
      EXPECT_TRUE(is_kept || is_lost);
      num_kept += is_kept ? 1 : 0;
    }
    EXPECT_EQ(num_kept, num_scans);
    EXPECT_THAT(store->DamagedScans(), IsEmpty());
    const bool has_upload = store->GetUpload("half").ok();
    EXPECT_EQ(ReadFile(dead_.File(has_upload ? "uploads/half" : "lost/upload-half")), payloads_[0].substr(0, 500));
    EXPECT_EQ(store->Recovery().num_orphaned_files, payloads_.size() - num_scans + (has_upload ? 0 : 1));
  }

  const std::vector<std::string> payloads_ = {RandomBytes(900, 1), RandomBytes(901, 2), RandomBytes(902, 3),
                                              RandomBytes(903, 4), RandomBytes(904, 5), RandomBytes(905, 6)};
  testing::TemporaryFolder living_;
  testing::TemporaryFolder dead_;
  const std::string log_ = dead_.File("curvereg.db-wal");
};

TEST_F(LostLogTest, WholeItGivesAllBack) { ExpectNothingIsRemoved(6); }

TEST_F(LostLogTest, Removed) {
  std::filesystem::remove(log_);
  ExpectNothingIsRemoved(3);
}

TEST_F(LostLogTest, CutAtItsBegin) {
  std::filesystem::resize_file(log_, 1'000);
  ExpectNothingIsRemoved(3);
}

TEST_F(LostLogTest, CutAtItsEnd) {
  const std::string log = ReadFile(log_);
  WriteFile(log_, log.substr(0, log.size() - 100));
  ExpectNothingIsRemoved(6);
}

TEST_F(LostLogTest, AByteOfItsHeaderIsChanged) {
  std::string log = ReadFile(log_);
  log[17] ^= 0x10;
  WriteFile(log_, log);
  ExpectNothingIsRemoved(3);
}

TEST_F(LostLogTest, AByteOfAPageIsChanged) {
  std::string log = ReadFile(log_);
  log[500] ^= 0x10;
  WriteFile(log_, log);
  ExpectNothingIsRemoved(3);
}

}  // namespace
}  // namespace curvereg::server
