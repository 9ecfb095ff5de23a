// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Unfinished uploads: resuming, fencing, refusals, expiry.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <atomic>
#include <thread>

#include "server/store/scan_store.h"
#include "tests/server/store/store_testing.h"

namespace curvereg::server {
namespace {

using ::testing::IsEmpty;
using testing::IsOk;
using ::testing::SizeIs;

class UploadWriterTest : public ::testing::Test {
 protected:
  std::unique_ptr<UploadWriter> Begin(const UploadDescription& description) {
    absl::StatusOr<std::unique_ptr<UploadWriter>> writer = store_->BeginUpload(description);
    EXPECT_THAT(writer, IsOk());
    return writer.ok() ? *std::move(writer) : nullptr;
  }
  void Reopen() {
    store_.reset();
    store_ = OpenStore(folder_.path());
  }

  const std::string payload_ = RandomBytes(2'500'000, 1);
  const std::string_view bytes_ = payload_;
  const UploadDescription description_ = Describe("upload-1", payload_);
  testing::TemporaryFolder folder_;
  std::unique_ptr<ScanStore> store_ = OpenStore(folder_.path());
};

TEST_F(UploadWriterTest, ResumesWhereItStopped) {
  ASSERT_THAT(Begin(description_)->Append(0, bytes_.substr(0, 1'000'000)), IsOk());
  const std::unique_ptr<UploadWriter> writer = Begin(description_);
  EXPECT_EQ(writer->committed_offset(), 1'000'000U);
  EXPECT_TRUE(wire::SameDigest(writer->PayloadDigest().value(), DigestOf(payload_.substr(0, 1'000'000))));
  ASSERT_THAT(writer->Append(1'000'000, bytes_.substr(1'000'000)), IsOk());
  const auto committed = writer->Commit(1, "c");
  ASSERT_THAT(committed, IsOk());
  EXPECT_EQ(store_->ReadWholePayload(committed->scan.id).value(), payload_);
}

TEST_F(UploadWriterTest, ResumesAfterReopening) {
  ASSERT_THAT(Begin(description_)->Append(0, bytes_.substr(0, 1'234'567)), IsOk());
  Reopen();
  EXPECT_EQ(store_->Statistics().num_uploads, 1U);
  EXPECT_EQ(store_->Statistics().stored_bytes, 1'234'567U);
  const absl::StatusOr<UploadState> state = store_->GetUpload("upload-1");
  ASSERT_THAT(state, IsOk());
  EXPECT_EQ(state->committed_offset, 1'234'567U);
  EXPECT_EQ(state->description.payload_bytes, payload_.size());
  EXPECT_EQ(state->description.header.SerializeAsString(), description_.header.SerializeAsString());
  EXPECT_TRUE(wire::SameDigest(*state->description.payload_digest, *description_.payload_digest));
  const std::unique_ptr<UploadWriter> writer = Begin(description_);
  EXPECT_EQ(writer->committed_offset(), 1'234'567U);
  ASSERT_THAT(writer->Append(1'234'567, bytes_.substr(1'234'567, 500'000)), IsOk());
  ASSERT_THAT(writer->Append(1'734'567, bytes_.substr(1'734'567)), IsOk());
  EXPECT_EQ(writer->ReadAll().value(), payload_);
  EXPECT_TRUE(wire::SameDigest(writer->PayloadDigest().value(), *description_.payload_digest));
  const auto committed = writer->Commit(1, "c");
  ASSERT_THAT(committed, IsOk());
  Reopen();
  EXPECT_EQ(store_->ReadWholePayload(committed->scan.id).value(), payload_);
  EXPECT_EQ(store_->Statistics().num_uploads, 0U);
}

TEST_F(UploadWriterTest, TakesNoMoreSpaceThanThePayloadNeeds) {
  const std::unique_ptr<UploadWriter> writer = Begin(description_);
  struct stat info {};
  for (std::size_t offset = 0; offset < bytes_.size(); offset += 500'000) {
    ASSERT_THAT(writer->Append(offset, bytes_.substr(offset, 500'000)), IsOk());
    ASSERT_EQ(stat((folder_.path() + "/uploads/upload-1").c_str(), &info), 0);
    EXPECT_EQ(info.st_size, static_cast<off_t>(offset) + 500'000) << "the length tells what is committed";
    EXPECT_LE(info.st_blocks * 512, 2'500'000 + 64 * 1024);
  }
}

TEST_F(UploadWriterTest, ASecondWriterFencesTheFirstOff) {
  const std::unique_ptr<UploadWriter> first = Begin(description_);
  ASSERT_THAT(first->Append(0, bytes_.substr(0, 1'000)), IsOk());
  const std::unique_ptr<UploadWriter> second = Begin(description_);
  EXPECT_THAT(first->Append(1'000, bytes_.substr(1'000)), HasReason(v1::ERROR_REASON_WRITER_REPLACED));
  EXPECT_THAT(first->ReadAll(), HasReason(v1::ERROR_REASON_WRITER_REPLACED));
  EXPECT_THAT(first->PayloadDigest(), HasReason(v1::ERROR_REASON_WRITER_REPLACED));
  EXPECT_THAT(first->Commit(0, ""), HasReason(v1::ERROR_REASON_WRITER_REPLACED));
  EXPECT_THAT(first->Discard(), HasReason(v1::ERROR_REASON_WRITER_REPLACED));
  EXPECT_EQ(second->committed_offset(), 1'000U);
  ASSERT_THAT(second->Append(1'000, bytes_.substr(1'000)), IsOk());
  ASSERT_THAT(second->Commit(0, ""), IsOk());
  EXPECT_THAT(second->Append(0, "x"), HasReason(v1::ERROR_REASON_WRITER_REPLACED));
  EXPECT_THAT(second->Commit(0, ""), HasReason(v1::ERROR_REASON_WRITER_REPLACED));
}

TEST_F(UploadWriterTest, WritersThatFightLoseAndMixNothing) {
  constexpr int kThreads = 4;
  constexpr uint64_t kChunk = 50'000;
  std::atomic<int> num_committed = 0;
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < kThreads; ++t) {
      threads.emplace_back([&] {
        while (num_committed == 0) {
          absl::StatusOr<std::unique_ptr<UploadWriter>> writer = store_->BeginUpload(description_);
          ASSERT_THAT(writer, IsOk());
          absl::Status status;
          // A few chunks at a time, so that the others' turns fall in between.
          for (int i = 0; i < 5 && status.ok() && (*writer)->committed_offset() < payload_.size(); ++i) {
            const uint64_t offset = (*writer)->committed_offset();
            status = (*writer)->Append(offset, bytes_.substr(offset, kChunk));
          }
          if (status.ok() && (*writer)->committed_offset() == payload_.size()) {
            if ((status = (*writer)->Commit(0, "").status()).ok()) ++num_committed;
          }
          if (!status.ok()) {
            EXPECT_THAT(status, HasReason(v1::ERROR_REASON_WRITER_REPLACED));
          }
        }
      });
    }
  }
  EXPECT_GE(num_committed, 1);
  const ScanPage page = store_->ListScans(10, "").value();
  ASSERT_THAT(page.scans, SizeIs(1));
  EXPECT_EQ(store_->ReadWholePayload(page.scans[0].id).value(), payload_);
}

TEST_F(UploadWriterTest, RefusesOffsetsThatDoNotFit) {
  const std::unique_ptr<UploadWriter> writer = Begin(description_);
  ASSERT_THAT(writer->Append(0, bytes_.substr(0, 100)), IsOk());
  for (const uint64_t offset : {uint64_t{0}, uint64_t{99}, uint64_t{101}, ~uint64_t{0}}) {
    const absl::Status status = writer->Append(offset, "x");
    EXPECT_THAT(status, HasReason(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE));
    EXPECT_EQ(wire::ErrorInfoOf(status)->metadata().at("committed_offset"), "100");
  }
  EXPECT_THAT(writer->Append(100, payload_), HasReason(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE));
  EXPECT_THAT(writer->Commit(0, ""), HasReason(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE));
  EXPECT_EQ(writer->committed_offset(), 100U);
  ASSERT_THAT(writer->Append(100, bytes_.substr(100)), IsOk());
  EXPECT_EQ(writer->ReadAll().value(), payload_);
}

TEST_F(UploadWriterTest, TheSameUploadMustBeDescribedTheSame) {
  UploadDescription no_digest = description_;
  no_digest.payload_digest.reset();
  Begin(no_digest);
  UploadDescription other_header = no_digest;
  other_header.header.set_frame_id("other");
  EXPECT_THAT(store_->BeginUpload(other_header), HasReason(v1::ERROR_REASON_UPLOAD_DIFFERS));
  UploadDescription other_size = no_digest;
  ++other_size.payload_bytes;
  EXPECT_THAT(store_->BeginUpload(other_size), HasReason(v1::ERROR_REASON_UPLOAD_DIFFERS));
  // A digest that comes later is kept, over a restart, too.
  Begin(description_);
  Reopen();
  UploadDescription other_digest = description_;
  other_digest.payload_digest = DigestOf("other");
  EXPECT_THAT(store_->BeginUpload(other_digest), HasReason(v1::ERROR_REASON_UPLOAD_DIFFERS));
  Begin(no_digest);
  EXPECT_EQ(store_->Statistics().num_uploads, 1U);
}

TEST_F(UploadWriterTest, RefusesNamesThatAreNone) {
  for (const std::string& id : {std::string(), std::string("../escape"), std::string("a/b"), std::string(65, 'a')}) {
    EXPECT_THAT(store_->BeginUpload(Describe(id, payload_)), HasReason(v1::ERROR_REASON_INVALID_FIELD));
    EXPECT_THAT(store_->GetUpload(id), HasReason(v1::ERROR_REASON_UPLOAD_NOT_FOUND));
  }
  EXPECT_THAT(store_->BeginUpload(Describe("empty", "")), HasReason(v1::ERROR_REASON_INVALID_FIELD));
}

TEST_F(UploadWriterTest, DiscardForgetsAllOfIt) {
  const std::unique_ptr<UploadWriter> writer = Begin(description_);
  ASSERT_THAT(writer->Append(0, bytes_.substr(0, 1'000)), IsOk());
  ASSERT_THAT(writer->Discard(), IsOk());
  EXPECT_THAT(store_->GetUpload("upload-1"), HasReason(v1::ERROR_REASON_UPLOAD_NOT_FOUND));
  EXPECT_THAT(writer->Append(1'000, "x"), HasReason(v1::ERROR_REASON_WRITER_REPLACED));
  EXPECT_THAT(FilesBelow(folder_.File("uploads")), IsEmpty());
  EXPECT_EQ(store_->Statistics().stored_bytes, 0U);
  EXPECT_EQ(Begin(description_)->committed_offset(), 0U);
}

TEST_F(UploadWriterTest, UploadsWithoutProgressExpire) {
  using std::chrono::hours;
  const auto now = std::chrono::system_clock::now();
  const std::unique_ptr<UploadWriter> writer = Begin(description_);
  ASSERT_THAT(writer->Append(0, bytes_.substr(0, 1'000)), IsOk());
  const auto expire_time = store_->GetUpload("upload-1")->expire_time;
  EXPECT_GE(expire_time, now + hours(24 * 7));
  EXPECT_LE(expire_time, std::chrono::system_clock::now() + hours(24 * 7));
  EXPECT_EQ(store_->ExpireUploads(now + hours(24 * 7 - 1)).value(), 0);
  EXPECT_EQ(store_->ExpireUploads(now + hours(24 * 7 + 1)).value(), 1);
  EXPECT_EQ(store_->ExpireUploads(now + hours(24 * 7 + 1)).value(), 0);
  EXPECT_THAT(store_->GetUpload("upload-1"), HasReason(v1::ERROR_REASON_UPLOAD_NOT_FOUND));
  EXPECT_THAT(writer->Append(1'000, "x"), HasReason(v1::ERROR_REASON_WRITER_REPLACED));
  EXPECT_THAT(FilesBelow(folder_.File("uploads")), IsEmpty());
  EXPECT_EQ(store_->Statistics().num_uploads, 0U);
  Reopen();
  EXPECT_EQ(store_->Statistics().num_uploads, 0U);
}

TEST_F(UploadWriterTest, TheTimeOfTheLastProgressOutlivesTheProcess) {
  ASSERT_THAT(Begin(description_)->Append(0, bytes_.substr(0, 1'000)), IsOk());
  store_.reset();
  const std::filesystem::path file = folder_.File("uploads/upload-1");
  std::filesystem::last_write_time(file, std::filesystem::last_write_time(file) - std::chrono::hours(100));
  store_ = OpenStore(folder_.path());
  const auto now = std::chrono::system_clock::now();
  EXPECT_EQ(store_->ExpireUploads(now + std::chrono::hours(67)).value(), 0);
  EXPECT_EQ(store_->ExpireUploads(now + std::chrono::hours(69)).value(), 1);
}

TEST_F(UploadWriterTest, AFileCutFromOutsideIsNotTakenForWhole) {
  ASSERT_THAT(Begin(description_)->Append(0, bytes_.substr(0, 1'000)), IsOk());
  std::filesystem::resize_file(folder_.File("uploads/upload-1"), 400);
  const std::unique_ptr<UploadWriter> writer = Begin(description_);
  EXPECT_EQ(writer->committed_offset(), 400U);
  ASSERT_THAT(writer->Append(400, bytes_.substr(400)), IsOk());
  const auto committed = writer->Commit(0, "");
  ASSERT_THAT(committed, IsOk());
  EXPECT_EQ(store_->ReadWholePayload(committed->scan.id).value(), payload_);
  EXPECT_EQ(store_->Statistics().stored_bytes, payload_.size());
}

}  // namespace
}  // namespace curvereg::server
