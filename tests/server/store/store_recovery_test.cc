// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A store that is opened again: damage, leftovers, locks, versions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "server/store/scan_store.h"
#include "tests/server/store/store_testing.h"

namespace curvereg::server {
namespace {

using ::testing::ElementsAre;
using testing::HasCode;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::IsOk;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;

class StoreRecoveryTest : public ::testing::Test {
 protected:
  void SetUp() override {
    store_ = OpenStore(folder_.path());
    id_ = Store(*store_, Describe("first", payload_), payload_)->scan.id;
    file_ = FilesBelow(folder_.File("payloads")).at(0);
  }
  void Reopen() {
    store_.reset();
    store_ = OpenStore(folder_.path());
    ASSERT_NE(store_, nullptr);
  }
  absl::Status OpeningError() { return ScanStore::Open(folder_.path(), {}).status(); }

  const std::string payload_ = RandomBytes(100'000, 1);
  testing::TemporaryFolder folder_;
  std::unique_ptr<ScanStore> store_;
  std::string id_;
  std::string file_;  // of the payload
};

TEST_F(StoreRecoveryTest, EverythingIsThereAgain) {
  const std::string other = RandomBytes(500, 2);
  const std::string second = Store(*store_, Describe("second", other), other)->scan.id;
  const ScanPage before = store_->ListScans(10, "").value();
  Reopen();
  const ScanPage after = store_->ListScans(10, "").value();
  ASSERT_THAT(after.scans, SizeIs(2));
  EXPECT_EQ(after.scans[0].id, second);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(after.scans[i].id, before.scans[i].id);
    EXPECT_EQ(after.scans[i].create_time, before.scans[i].create_time);
    EXPECT_EQ(after.scans[i].content_digest, before.scans[i].content_digest);
  }
  EXPECT_EQ(store_->ReadWholePayload(id_).value(), payload_);
  EXPECT_EQ(store_->Statistics().num_scans, 2U);
  EXPECT_EQ(store_->Statistics().stored_bytes, payload_.size() + other.size());
}

TEST_F(StoreRecoveryTest, PlacesOfDeletedScansAreNotUsedAgain) {
  const std::string token = [&] {
    const std::string other = RandomBytes(500, 2);
    EXPECT_THAT(Store(*store_, Describe("second", other), other), IsOk());
    return store_->ListScans(1, "")->next_page_token;
  }();
  const std::string newest = store_->ListScans(1, "")->scans[0].id;
  ASSERT_THAT(store_->DeleteScan(newest), IsOk());
  Reopen();
  const std::string third = RandomBytes(500, 3);
  ASSERT_THAT(Store(*store_, Describe("third", third), third), IsOk());
  const ScanPage page = store_->ListScans(5, token).value();
  ASSERT_THAT(page.scans, SizeIs(1));
  EXPECT_EQ(page.scans[0].id, id_);
}

TEST_F(StoreRecoveryTest, AMissingOrCutPayloadIsReportedAndRefused) {
  const std::string other = RandomBytes(500, 2);
  const std::string cut = Store(*store_, Describe("second", other), other)->scan.id;
  const std::string good_payload = RandomBytes(600, 3);
  const std::string good = Store(*store_, Describe("third", good_payload), good_payload)->scan.id;
  EXPECT_THAT(store_->DamagedScans(), IsEmpty());
  store_.reset();
  for (const std::string& file : FilesBelow(folder_.File("payloads"))) {
    if (std::filesystem::file_size(file) == other.size()) std::filesystem::resize_file(file, 499);
  }
  std::filesystem::remove(file_);
  store_ = OpenStore(folder_.path());
  EXPECT_THAT(store_->DamagedScans(), UnorderedElementsAre(id_, cut));
  for (const std::string& id : {id_, cut}) {
    EXPECT_THAT(store_->GetScan(id), IsOk());
    EXPECT_THAT(store_->ReadPayload(id, 0, 10), HasReason(v1::ERROR_REASON_STORED_SCAN_DAMAGED));
    EXPECT_THAT(store_->ReadWholePayload(id), HasReason(v1::ERROR_REASON_STORED_SCAN_DAMAGED));
  }
  EXPECT_EQ(store_->ReadWholePayload(good).value(), good_payload);
  ASSERT_THAT(store_->DeleteScan(cut), IsOk());
  EXPECT_THAT(store_->DamagedScans(), ElementsAre(id_));
}

TEST_F(StoreRecoveryTest, DamageIsFoundWhileRunning) {
  std::filesystem::resize_file(file_, 10);
  EXPECT_THAT(store_->ReadPayload(id_, 0, 100), HasReason(v1::ERROR_REASON_STORED_SCAN_DAMAGED));
  EXPECT_THAT(store_->DamagedScans(), ElementsAre(id_));
}

TEST_F(StoreRecoveryTest, AChangedBitIsFoundAndMendedByUploadingAgain) {
  const std::string rear = Store(*store_, Describe("rear", payload_, "rear"), payload_)->scan.id;
  std::string changed = payload_;
  changed[77'777] ^= 4;
  std::filesystem::permissions(file_, std::filesystem::perms::owner_all);
  WriteFile(file_, changed);
  EXPECT_THAT(store_->ReadWholePayload(id_), HasReason(v1::ERROR_REASON_STORED_SCAN_DAMAGED));
  EXPECT_THAT(store_->DamagedScans(), UnorderedElementsAre(id_, rear));
  // Not answered from what is damaged.
  EXPECT_FALSE(store_->FindScan(Describe("x", payload_)).value().has_value());
  const auto again = Store(*store_, Describe("again", payload_), payload_);
  ASSERT_THAT(again, IsOk());
  EXPECT_TRUE(again->already_stored);
  EXPECT_EQ(again->scan.id, id_);
  EXPECT_THAT(store_->DamagedScans(), IsEmpty());
  EXPECT_EQ(store_->ReadWholePayload(id_).value(), payload_);
  EXPECT_EQ(store_->ReadWholePayload(rear).value(), payload_);
  EXPECT_EQ(store_->Statistics().stored_bytes, payload_.size());
}

TEST_F(StoreRecoveryTest, AHeaderChangedBehindOurBackIsDamage) {
  store_.reset();
  v1::PointCloudHeader other = HeaderOf("forged");
  RunSql(folder_.File("curvereg.db"), "UPDATE scans SET header=x'ffff'");
  store_ = OpenStore(folder_.path());
  EXPECT_THAT(store_->DamagedScans(), ElementsAre(id_));
  EXPECT_THAT(store_->ReadWholePayload(id_), HasReason(v1::ERROR_REASON_STORED_SCAN_DAMAGED));
  EXPECT_THAT(store_->ListScans(10, "")->scans, SizeIs(1));
}

TEST_F(StoreRecoveryTest, DamageThatSomebodyFoundIsChecked) {
  EXPECT_THAT(store_->CheckScan(id_), IsOk());
  EXPECT_THAT(store_->CheckScan(std::string(32, '0')), HasReason(v1::ERROR_REASON_SCAN_NOT_FOUND));
  std::string changed = payload_;
  changed.back() ^= 1;
  WriteFile(file_, changed);
  EXPECT_THAT(store_->CheckScan(id_), HasReason(v1::ERROR_REASON_STORED_SCAN_DAMAGED));
  EXPECT_THAT(store_->DamagedScans(), ElementsAre(id_));
}

TEST_F(StoreRecoveryTest, ADamagedDatabaseIsSaidSo) {
  store_.reset();
  const std::string path = folder_.File("curvereg.db");
  const std::string whole = ReadFile(path);
  ASSERT_GT(whole.size(), 8'192U);
  std::string garbled = whole;
  for (std::size_t i = 4'096; i < garbled.size(); ++i) garbled[i] ^= 0x5a;
  for (const std::string& bytes : {garbled, std::string(20'000, 'x'), whole.substr(0, 5'000)}) {
    WriteFile(path, bytes);
    const absl::Status status = OpeningError();
    EXPECT_THAT(status, HasCode(absl::StatusCode::kDataLoss));
    EXPECT_THAT(std::string(status.message()), HasSubstr(path));
    EXPECT_THAT(std::string(status.message()), HasSubstr("backup"));
  }
  EXPECT_TRUE(std::filesystem::exists(file_)) << "a damaged database must not cost a payload";
  WriteFile(path, whole);
  EXPECT_THAT(OpeningError(), IsOk());
}

TEST_F(StoreRecoveryTest, ALostDatabaseDoesNotCostThePayloads) {
  store_.reset();
  const std::string path = folder_.File("curvereg.db");
  const std::string whole = ReadFile(path);
  std::filesystem::remove(path);
  for (int i = 0; i < 2; ++i) EXPECT_THAT(OpeningError(), HasCode(absl::StatusCode::kDataLoss));
  WriteFile(path, "");
  EXPECT_THAT(OpeningError(), HasCode(absl::StatusCode::kDataLoss));
  EXPECT_TRUE(std::filesystem::exists(file_));
  WriteFile(path, whole);
  store_ = OpenStore(folder_.path());
  EXPECT_EQ(store_->ReadWholePayload(id_).value(), payload_);
}

TEST_F(StoreRecoveryTest, ANewerVersionIsLeftAlone) {
  store_.reset();
  RunSql(folder_.File("curvereg.db"), "PRAGMA user_version=1000");
  const absl::Status status = OpeningError();
  EXPECT_THAT(status, HasCode(absl::StatusCode::kFailedPrecondition));
  EXPECT_THAT(std::string(status.message()), HasSubstr("newer"));
  EXPECT_TRUE(std::filesystem::exists(file_));
}

TEST_F(StoreRecoveryTest, OneProcessAtATime) {
  EXPECT_THAT(OpeningError(), HasCode(absl::StatusCode::kFailedPrecondition));
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  // Nothing but the answer leaves the child.
  if (child == 0) _exit(absl::IsFailedPrecondition(OpeningError()) ? 0 : 1);
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  store_.reset();
  EXPECT_THAT(OpeningError(), IsOk());
}

TEST_F(StoreRecoveryTest, FoldersThatCannotBeUsedAreNamed) {
  const std::string in_file = file_ + "/folder";
  const absl::Status status = ScanStore::Open(in_file, {}).status();
  EXPECT_FALSE(status.ok());
  EXPECT_THAT(std::string(status.message()), HasSubstr(in_file));
  testing::TemporaryFolder parent;
  EXPECT_THAT(ScanStore::Open(parent.File("a/b/c"), {}), IsOk());
  EXPECT_THAT(ScanStore::Open(parent.File("a/d/"), {}), IsOk());
}

}  // namespace
}  // namespace curvereg::server
