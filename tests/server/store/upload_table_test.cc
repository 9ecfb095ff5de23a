// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/store/upload_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "server/store/store_folder.h"
#include "tests/server/store/store_testing.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

using std::chrono::hours;
using std::chrono::system_clock;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using testing::IsOk;
using ::testing::Pair;
using ::testing::UnorderedElementsAre;

constexpr uint64_t kMaxBytes = 10'000;

class UploadTableTest : public ::testing::Test {
 protected:
  UploadTableTest() { Reopen(); }

  // As a process that died and was started again.
  void Reopen() {
    table_.reset();
    folder_store_.reset();
    auto folder = StoreFolder::Open(folder_.path());
    ASSERT_THAT(folder, IsOk());
    folder_store_ = *std::move(folder);
    space_ = std::make_unique<StoreSpace>(kMaxBytes);
    table_ = std::make_unique<UploadTable>(folder_store_->uploads_path(), options_, *folder_store_->catalog,
                                           folder_store_->removals, *space_);
    set_aside_.clear();
    ASSERT_THAT(table_->Load({},
                             [this](const std::string& path, const std::string& name) {
                               set_aside_[name] = ReadFile(path);
                               return RemoveFile(path);
                             }),
                IsOk());
  }
  UploadTable::Grant Begin(const std::string& id, const std::string& payload) {
    auto grant = table_->Begin(Describe(id, payload));
    EXPECT_THAT(grant, IsOk());
    return *std::move(grant);
  }
  // Writes the bytes at the committed offset.
  void Append(UploadTable::Grant& grant, const std::string& bytes) {
    const std::lock_guard lock(grant.upload->mutex);
    ASSERT_THAT(grant.file.WriteAt(grant.upload->committed_offset, bytes), IsOk());
    table_->AddProgress(*grant.upload, bytes.size());
  }
  void Drop(const UploadTable::Grant& grant) {
    const std::lock_guard lock(grant.upload->mutex);
    table_->Drop(*grant.upload);
  }
  std::string PathOf(const std::string& id) const { return folder_.File("uploads/" + id); }

  const ScanStoreOptions options_{.max_stored_bytes = kMaxBytes, .max_uploads = 2, .upload_lifetime = hours(1)};
  const std::string payload_ = RandomBytes(4000, 1);
  testing::TemporaryFolder folder_;
  std::unique_ptr<StoreFolder> folder_store_;
  std::unique_ptr<StoreSpace> space_;
  std::unique_ptr<UploadTable> table_;
  std::map<std::string, std::string> set_aside_;  // names and bytes
};

TEST_F(UploadTableTest, BeginningAgainGoesOnWithAHigherEpoch) {
  UploadTable::Grant first = Begin("a", payload_);
  EXPECT_EQ(first.committed_offset, 0U);
  Append(first, payload_.substr(0, 100));
  const UploadTable::Grant second = Begin("a", payload_);
  EXPECT_EQ(second.upload, first.upload);
  EXPECT_EQ(second.committed_offset, 100U);
  EXPECT_GT(second.epoch, first.epoch);
  EXPECT_EQ(table_->num_uploads(), 1U);
  EXPECT_EQ(space_->StoredBytes(), 100U);
}

TEST_F(UploadTableTest, AnotherUploadOfTheSameNameDiffers) {
  Begin("a", payload_);
  EXPECT_THAT(table_->Begin(Describe("a", payload_, "other frame")), HasReason(v1::ERROR_REASON_UPLOAD_DIFFERS));
  EXPECT_THAT(table_->Begin(Describe("a", RandomBytes(4000, 2))), HasReason(v1::ERROR_REASON_UPLOAD_DIFFERS));
  UploadDescription without_digest = Describe("a", payload_);
  without_digest.payload_digest.reset();
  EXPECT_THAT(table_->Begin(without_digest), IsOk()) << "it may come at the end";
}

TEST_F(UploadTableTest, NamesAreChecked) {
  for (const std::string& id : {std::string(), std::string("A"), std::string("a/b"), std::string(65, 'a')}) {
    EXPECT_THAT(table_->Begin(Describe(id, payload_)), HasReason(v1::ERROR_REASON_INVALID_FIELD)) << id;
  }
}

TEST_F(UploadTableTest, ThereAreOnlySoMany) {
  const UploadTable::Grant first = Begin("a", "1");
  Begin("b", "2");
  const auto refused = table_->Begin(Describe("c", "3"));
  EXPECT_THAT(refused, HasReason(v1::ERROR_REASON_TOO_MANY_UPLOADS));
  EXPECT_TRUE(wire::RetryDelayOf(refused.status()).has_value());
  Begin("a", "1");  // which is there already
  Drop(first);
  EXPECT_THAT(table_->Begin(Describe("c", "3")), IsOk());
}

TEST_F(UploadTableTest, DeclaredBytesAreSetAside) {
  const UploadTable::Grant first = Begin("a", RandomBytes(6000, 1));
  EXPECT_THAT(table_->Begin(Describe("b", RandomBytes(4001, 2))), HasReason(v1::ERROR_REASON_STORAGE_FULL));
  Drop(first);
  EXPECT_THAT(table_->Begin(Describe("b", RandomBytes(10'000, 2))), IsOk());
}

TEST_F(UploadTableTest, KnowsTheStateOfWhatGoesOn) {
  EXPECT_THAT(table_->State("a"), HasReason(v1::ERROR_REASON_UPLOAD_NOT_FOUND));
  const auto before = system_clock::now();
  UploadTable::Grant grant = Begin("a", payload_);
  Append(grant, payload_.substr(0, 7));
  const auto state = table_->State("a");
  ASSERT_THAT(state, IsOk());
  EXPECT_EQ(state->committed_offset, 7U);
  EXPECT_EQ(state->description.payload_bytes, payload_.size());
  EXPECT_GE(state->expire_time, before + hours(1));
  EXPECT_LE(state->expire_time, system_clock::now() + hours(1));
  Drop(grant);
  EXPECT_THAT(table_->State("a"), HasReason(v1::ERROR_REASON_UPLOAD_NOT_FOUND));
  EXPECT_FALSE(LookAt(PathOf("a")).has_value());
  EXPECT_EQ(space_->StoredBytes(), 0U);
}

TEST_F(UploadTableTest, ForgetsWhatMadeNoProgressForItsLifetime) {
  Begin("a", payload_);
  EXPECT_EQ(*table_->Expire(system_clock::now() + std::chrono::minutes(59)), 0);
  EXPECT_EQ(*table_->Expire(system_clock::now() + std::chrono::minutes(61)), 1);
  EXPECT_EQ(table_->num_uploads(), 0U);
  EXPECT_FALSE(LookAt(PathOf("a")).has_value());
  Reopen();
  EXPECT_EQ(table_->num_uploads(), 0U) << "its row is gone, too";
}

TEST_F(UploadTableTest, GoesOnAfterARestart) {
  {
    UploadTable::Grant grant = Begin("a", payload_);
    Append(grant, payload_.substr(0, 1000));
  }
  Reopen();
  EXPECT_EQ(space_->StoredBytes(), 1000U);
  EXPECT_EQ(Begin("a", payload_).committed_offset, 1000U);
  EXPECT_THAT(table_->Begin(Describe("b", RandomBytes(6001, 2))), HasReason(v1::ERROR_REASON_STORAGE_FULL))
      << "the declared bytes are still set aside";
  EXPECT_THAT(table_->emptied(), IsEmpty());
  EXPECT_THAT(set_aside_, IsEmpty());
}

TEST_F(UploadTableTest, FilesThatNoRowNamesAreSetAsideUnlessTheyAreEmpty) {
  WriteFile(PathOf("stranger"), "bytes");
  WriteFile(PathOf("empty"), "");
  WriteFile(PathOf("Not.Ours"), "bytes");
  Reopen();
  EXPECT_THAT(set_aside_, ElementsAre(Pair("upload-stranger", "bytes")));
  EXPECT_THAT(FilesBelow(folder_.File("uploads")), ElementsAre(PathOf("Not.Ours")));
}

TEST_F(UploadTableTest, UploadsWithoutTheirBytesBeginAnew) {
  for (const char* id : {"gone", "longer"}) {
    UploadTable::Grant grant = Begin(id, payload_);
    Append(grant, payload_.substr(0, 1000));
  }
  table_.reset();
  std::filesystem::remove(PathOf("gone"));
  WriteFile(PathOf("longer"), payload_ + "more than was declared");
  Reopen();
  EXPECT_THAT(table_->emptied(), UnorderedElementsAre("gone", "longer"));
  EXPECT_EQ(Begin("gone", payload_).committed_offset, 0U);
  EXPECT_EQ(Begin("longer", payload_).committed_offset, 0U);
}

TEST_F(UploadTableTest, AFileCutShortFromOutsideGoesOnWhereItEnds) {
  UploadTable::Grant grant = Begin("a", payload_);
  Append(grant, payload_.substr(0, 1000));
  std::filesystem::resize_file(PathOf("a"), 600);
  EXPECT_EQ(Begin("a", payload_).committed_offset, 600U);
  EXPECT_EQ(space_->StoredBytes(), 600U);
}

}  // namespace
}  // namespace curvereg::server
