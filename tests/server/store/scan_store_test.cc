// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/store/scan_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <thread>

#include "tests/server/store/store_testing.h"

namespace curvereg::server {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using testing::IsOk;
using ::testing::SizeIs;

class ScanStoreTest : public ::testing::Test {
 protected:
  std::unique_ptr<UploadWriter> Begin(const UploadDescription& description) {
    absl::StatusOr<std::unique_ptr<UploadWriter>> writer = store_->BeginUpload(description);
    EXPECT_THAT(writer, IsOk());
    return writer.ok() ? *std::move(writer) : nullptr;
  }
  // The scan's id.
  std::string Add(const std::string& payload, const std::string& frame_id = "lidar") {
    const auto committed = Store(*store_, Describe("some-upload", payload, frame_id), payload);
    EXPECT_THAT(committed, IsOk());
    return committed.ok() ? committed->scan.id : "";
  }
  std::vector<std::string> PayloadFiles() { return FilesBelow(folder_.File("payloads")); }

  testing::TemporaryFolder folder_;
  std::unique_ptr<ScanStore> store_ = OpenStore(folder_.path());
};

TEST_F(ScanStoreTest, IsEmptyAtFirst) {
  const StoreStatistics statistics = store_->Statistics();
  EXPECT_EQ(statistics.num_scans, 0U);
  EXPECT_EQ(statistics.num_uploads, 0U);
  EXPECT_EQ(statistics.stored_bytes, 0U);
  const absl::StatusOr<ScanPage> page = store_->ListScans(10, "");
  ASSERT_THAT(page, IsOk());
  EXPECT_THAT(page->scans, IsEmpty());
  EXPECT_EQ(page->next_page_token, "");
  EXPECT_THAT(store_->DamagedScans(), IsEmpty());
}

TEST_F(ScanStoreTest, GivesBackWhatWasUploaded) {
  const std::string payload = RandomBytes(3'000'001, 1);
  const UploadDescription description = Describe("a-1", payload);
  const auto before = std::chrono::system_clock::now();
  const std::unique_ptr<UploadWriter> writer = Begin(description);
  EXPECT_EQ(writer->committed_offset(), 0U);
  for (uint64_t offset = 0; offset < payload.size();) {
    const std::string_view chunk = std::string_view(payload).substr(offset, 262'144);
    ASSERT_THAT(writer->Append(offset, chunk), IsOk());
    offset += chunk.size();
    EXPECT_EQ(writer->committed_offset(), offset);
    EXPECT_EQ(store_->Statistics().stored_bytes, offset);
  }
  EXPECT_EQ(writer->ReadAll().value(), payload);
  EXPECT_TRUE(wire::SameDigest(writer->PayloadDigest().value(), *description.payload_digest));
  EXPECT_FALSE(store_->FindScan(description).value().has_value());
  const absl::StatusOr<UploadWriter::Committed> committed = writer->Commit(6, "abc");
  ASSERT_THAT(committed, IsOk());
  EXPECT_FALSE(committed->already_stored);

  const absl::StatusOr<StoredScan> scan = store_->GetScan(committed->scan.id);
  ASSERT_THAT(scan, IsOk());
  EXPECT_THAT(scan->id, ::testing::MatchesRegex("[0-9a-f]{32}"));
  EXPECT_EQ(scan->header.SerializeAsString(), description.header.SerializeAsString());
  EXPECT_EQ(scan->payload_bytes, payload.size());
  EXPECT_TRUE(wire::SameDigest(scan->payload_digest, *description.payload_digest));
  EXPECT_EQ(scan->finite_point_count, 6U);
  EXPECT_EQ(scan->content_digest, "abc");
  EXPECT_GE(scan->create_time, before);
  EXPECT_LE(scan->create_time, std::chrono::system_clock::now());
  EXPECT_EQ(store_->ReadWholePayload(scan->id).value(), payload);
  EXPECT_EQ(store_->FindScan(description).value()->id, scan->id);
  EXPECT_EQ(store_->Statistics().num_scans, 1U);
  EXPECT_EQ(store_->Statistics().num_uploads, 0U);
  EXPECT_EQ(store_->Statistics().stored_bytes, payload.size());
  EXPECT_THAT(FilesBelow(folder_.File("uploads")), IsEmpty());
}

TEST_F(ScanStoreTest, ReadsAnyPieceOfAPayload) {
  const std::string payload = RandomBytes(10'000, 2);
  const std::string id = Add(payload);
  EXPECT_EQ(store_->ReadPayload(id, 0, 100).value(), payload.substr(0, 100));
  EXPECT_EQ(store_->ReadPayload(id, 9'990, 100).value(), payload.substr(9'990));
  EXPECT_EQ(store_->ReadPayload(id, 0, ~uint64_t{0}).value(), payload);
  EXPECT_EQ(store_->ReadPayload(id, 10'000, 1).value(), "");
  EXPECT_EQ(store_->ReadPayload(id, 5, 0).value(), "");
  EXPECT_THAT(store_->ReadPayload(id, 10'001, 1), HasReason(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE));
  EXPECT_THAT(store_->ReadPayload("nothing", 0, 1), HasReason(v1::ERROR_REASON_SCAN_NOT_FOUND));
  EXPECT_THAT(store_->ReadWholePayload("nothing"), HasReason(v1::ERROR_REASON_SCAN_NOT_FOUND));
  EXPECT_THAT(store_->GetScan("nothing"), HasReason(v1::ERROR_REASON_SCAN_NOT_FOUND));
}

TEST_F(ScanStoreTest, TheSameContentTwiceIsOneScan) {
  const std::string payload = RandomBytes(50'000, 3);
  const std::string id = Add(payload);
  const auto again = Store(*store_, Describe("another-upload", payload), payload);
  ASSERT_THAT(again, IsOk());
  EXPECT_TRUE(again->already_stored);
  EXPECT_EQ(again->scan.id, id);
  EXPECT_THAT(store_->ListScans(10, "")->scans, SizeIs(1));
  EXPECT_EQ(store_->Statistics().num_scans, 1U);
  EXPECT_EQ(store_->Statistics().num_uploads, 0U);
  EXPECT_EQ(store_->Statistics().stored_bytes, payload.size());
  EXPECT_THAT(PayloadFiles(), SizeIs(1));
}

TEST_F(ScanStoreTest, OnePayloadUnderTwoHeadersIsTwoScansAndOneFile) {
  const std::string payload = RandomBytes(50'000, 4);
  const std::string front = Add(payload, "front");
  const std::string rear = Add(payload, "rear");
  EXPECT_NE(front, rear);
  EXPECT_EQ(store_->Statistics().num_scans, 2U);
  EXPECT_EQ(store_->Statistics().stored_bytes, payload.size());
  EXPECT_THAT(PayloadFiles(), SizeIs(1));
  ASSERT_THAT(store_->DeleteScan(front), IsOk());
  EXPECT_THAT(store_->GetScan(front), HasReason(v1::ERROR_REASON_SCAN_NOT_FOUND));
  EXPECT_EQ(store_->ReadWholePayload(rear).value(), payload);
  EXPECT_EQ(store_->Statistics().stored_bytes, payload.size());
  ASSERT_THAT(store_->DeleteScan(rear), IsOk());
  EXPECT_THAT(PayloadFiles(), IsEmpty());
  EXPECT_EQ(store_->Statistics().num_scans, 0U);
  EXPECT_EQ(store_->Statistics().stored_bytes, 0U);
  EXPECT_THAT(store_->DeleteScan(rear), HasReason(v1::ERROR_REASON_SCAN_NOT_FOUND));
}

TEST_F(ScanStoreTest, FindsOnlyWhatIsTheSame) {
  const std::string payload = RandomBytes(1'000, 5);
  Add(payload);
  EXPECT_TRUE(store_->FindScan(Describe("x", payload)).value().has_value());
  EXPECT_FALSE(store_->FindScan(Describe("x", payload, "other")).value().has_value());
  EXPECT_FALSE(store_->FindScan(Describe("x", RandomBytes(1'000, 6))).value().has_value());
  UploadDescription no_digest = Describe("x", payload);
  no_digest.payload_digest.reset();
  EXPECT_FALSE(store_->FindScan(no_digest).value().has_value());
  UploadDescription other_digest = Describe("x", payload);
  other_digest.payload_digest = wire::DigestOf(v1::DIGEST_ALGORITHM_SHA256, payload);
  EXPECT_FALSE(store_->FindScan(other_digest).value().has_value());
  UploadDescription other_size = Describe("x", payload);
  ++other_size.payload_bytes;
  EXPECT_FALSE(store_->FindScan(other_size).value().has_value());
}

TEST_F(ScanStoreTest, PagesStayWhileScansComeAndGo) {
  std::vector<std::string> ids;
  for (uint64_t i = 0; i < 7; ++i) ids.push_back(Add(RandomBytes(100, 100 + i)));
  const ScanPage first = store_->ListScans(3, "").value();
  ASSERT_THAT(first.scans, SizeIs(3));
  EXPECT_EQ(first.scans[0].id, ids[6]);
  EXPECT_EQ(first.scans[2].id, ids[4]);
  // The scan at the end of the page goes, and so does one of the next page; a new one comes.
  ASSERT_THAT(store_->DeleteScan(ids[4]), IsOk());
  ASSERT_THAT(store_->DeleteScan(ids[2]), IsOk());
  const std::string newest = Add(RandomBytes(100, 200));
  const ScanPage second = store_->ListScans(2, first.next_page_token).value();
  ASSERT_THAT(second.scans, SizeIs(2));
  EXPECT_EQ(second.scans[0].id, ids[3]);
  EXPECT_EQ(second.scans[1].id, ids[1]);
  const ScanPage third = store_->ListScans(2, second.next_page_token).value();
  ASSERT_THAT(third.scans, SizeIs(1));
  EXPECT_EQ(third.scans[0].id, ids[0]);
  EXPECT_EQ(third.next_page_token, "");
  EXPECT_EQ(store_->ListScans(1, "").value().scans[0].id, newest);
  // A page that takes all that is left is the last.
  EXPECT_EQ(store_->ListScans(6, "").value().next_page_token, "");
}

TEST_F(ScanStoreTest, TakesOnlyItsOwnPageTokens) {
  for (uint64_t i = 0; i < 3; ++i) Add(RandomBytes(100, i));
  const std::string token = store_->ListScans(1, "").value().next_page_token;
  ASSERT_THAT(store_->ListScans(1, token), IsOk());
  std::string changed = token;
  changed[3] = changed[3] == '0' ? '1' : '0';
  for (const std::string& other : {changed, token + "0", token.substr(1), std::string("x"), std::string("-1"),
                                   std::string(24, '0'), std::string("\0\0", 2)}) {
    const absl::StatusOr<ScanPage> page = store_->ListScans(1, other);
    EXPECT_THAT(page, HasReason(v1::ERROR_REASON_INVALID_FIELD));
    EXPECT_EQ(wire::BadRequestOf(page.status())->field_violations(0).field(), "page_token");
  }
}

TEST_F(ScanStoreTest, ThreadsStoreTheSameAndOtherScansAtOnce) {
  constexpr int kThreads = 6;
  constexpr uint64_t kScans = 8;
  std::vector<std::string> payloads;
  for (uint64_t i = 0; i < kScans; ++i) payloads.push_back(RandomBytes(20'000 + i, 300 + i));
  std::atomic<int> num_new = 0;
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < kThreads; ++t) {
      threads.emplace_back([&, t] {
        for (uint64_t i = 0; i < kScans; ++i) {
          const std::string id = "t" + std::to_string(t) + "-" + std::to_string(i);
          const auto committed = Store(*store_, Describe(id, payloads[i]), payloads[i]);
          ASSERT_THAT(committed, IsOk());
          if (!committed->already_stored) ++num_new;
          EXPECT_EQ(store_->ReadWholePayload(committed->scan.id).value(), payloads[i]);
        }
      });
    }
  }
  EXPECT_EQ(num_new, static_cast<int>(kScans));
  EXPECT_THAT(store_->ListScans(100, "")->scans, SizeIs(kScans));
  EXPECT_THAT(PayloadFiles(), SizeIs(kScans));
  EXPECT_EQ(store_->Statistics().num_scans, kScans);
  EXPECT_EQ(store_->Statistics().num_uploads, 0U);
}

TEST_F(ScanStoreTest, AScanMayGoAndComeBackWhileItIsRead) {
  const std::string payload = RandomBytes(100'000, 7);
  const std::string id = Add(payload);
  std::atomic<bool> is_done = false;
  std::jthread reader([&] {
    while (!is_done) {
      const absl::StatusOr<std::string> bytes = store_->ReadWholePayload(id);
      if (bytes.ok()) {
        EXPECT_EQ(*bytes, payload);
      } else {
        EXPECT_THAT(bytes, HasReason(v1::ERROR_REASON_SCAN_NOT_FOUND));
      }
    }
  });
  for (int i = 0; i < 20; ++i) {
    ASSERT_THAT(store_->DeleteScan(id), IsOk());
    EXPECT_EQ(Add(payload), id);
  }
  is_done = true;
  reader.join();
  EXPECT_THAT(store_->DamagedScans(), IsEmpty());
  EXPECT_EQ(store_->Statistics().stored_bytes, payload.size());
}

}  // namespace
}  // namespace curvereg::server
