// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/scans/scan_intake.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/store/scan_identity.h"
#include "tests/server/scans/scan_server.h"
#include "tests/server/store/store_testing.h"

namespace curvereg::server {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::MetadataOf;
using testing::RandomCloud;
using Overlap = ScanIntake::Overlap;

class ScanIntakeTest : public ::testing::Test {
 protected:
  UploadEnvironment Environment() {
    UploadEnvironment environment = {
        .limits = {}, .memory = &memory_, .store = store_.get(), .metrics = &metrics_, .owners = &owners_};
    environment.limits.max_chunk_bytes = 600;
    return environment;
  }

  static UploadDescription DescriptionOf(const v1::PointCloud& cloud, const std::string& upload = "a") {
    return {upload, cloud.header(), cloud.data().size(), DigestOf(cloud.data())};
  }

  // The bytes [offset, offset + size) of the payload, with their CRC.
  static absl::Status Append(ScanIntake& intake, const std::string& payload, uint64_t offset, uint64_t size,
                             Overlap overlap = Overlap::kRefuse) {
    const std::string_view data = std::string_view(payload).substr(offset, size);
    const uint32_t crc32c = wire::Crc32c(data);
    return intake.Append({offset, {&data, 1}, crc32c, crc32c}, overlap);
  }

  std::string StoredPayload(const std::string& scan_id) { return *store_->ReadWholePayload(scan_id); }
  std::string ReasonOfUpload() { return testing::ReasonText(store_->GetUpload("a").status()); }
  bool MetricsHave(const std::string& line) { return metrics_.Text().find(line + "\n") != std::string::npos; }

  const testing::TemporaryFolder folder_;
  std::unique_ptr<ScanStore> store_ = OpenStore(folder_.path());
  MemoryBudget memory_{uint64_t{64} << 20};
  Metrics metrics_;
  UploadOwners owners_;
  const UploadEnvironment environment_ = Environment();
  const v1::PointCloud cloud_ = RandomCloud(100, 1);  // 1200 bytes
  const std::string& payload_ = cloud_.data();
};

TEST_F(ScanIntakeTest, MakesAScanOfItsChunks) {
  ScanIntake intake(environment_, std::stop_source());
  EXPECT_FALSE(intake.has_begun());
  const auto known = intake.Begin(DescriptionOf(cloud_));
  ASSERT_THAT(known, IsOk());
  EXPECT_FALSE(known->has_value());
  EXPECT_TRUE(intake.has_begun());
  EXPECT_EQ(intake.committed_offset(), 0);
  ASSERT_THAT(Append(intake, payload_, 0, 600), IsOk());
  EXPECT_EQ(intake.committed_offset(), 600);
  EXPECT_FALSE(intake.is_complete());
  ASSERT_THAT(Append(intake, payload_, 600, 600), IsOk());
  EXPECT_TRUE(intake.is_complete());
  const auto committed = intake.Finish(DigestOf(payload_));
  ASSERT_THAT(committed, IsOk());
  EXPECT_FALSE(committed->already_stored);
  EXPECT_EQ(committed->scan.id, ScanId(cloud_.header(), DigestOf(payload_)));
  EXPECT_EQ(committed->scan.finite_point_count, 100);
  EXPECT_EQ(StoredPayload(committed->scan.id), payload_);
  EXPECT_EQ(intake.committed_offset(), 1200);
  EXPECT_EQ(memory_.reserved_bytes(), 0);
}

TEST_F(ScanIntakeTest, CountsFinitePointsWithoutDecoding) {
  v1::PointCloud cloud = cloud_;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const int point : {7, 50}) {
    cloud.mutable_data()->replace(static_cast<std::size_t>(point) * 12, sizeof(nan),
                                  reinterpret_cast<const char*>(&nan), sizeof(nan));
  }
  ScanIntake intake(environment_, std::stop_source());
  ASSERT_THAT(intake.Begin(DescriptionOf(cloud)), IsOk());
  // A cut within a coordinate.
  ASSERT_THAT(Append(intake, cloud.data(), 0, 599), IsOk());
  ASSERT_THAT(Append(intake, cloud.data(), 599, 600), IsOk());
  ASSERT_THAT(Append(intake, cloud.data(), 1199, 1), IsOk());
  const auto committed = intake.Finish(DigestOf(cloud.data()));
  ASSERT_THAT(committed, IsOk());
  EXPECT_EQ(committed->scan.finite_point_count, 98);
}

TEST_F(ScanIntakeTest, GoesOnWhereAnEarlierOneWasCut) {
  {
    ScanIntake cut(environment_, std::stop_source());
    ASSERT_THAT(cut.Begin(DescriptionOf(cloud_)), IsOk());
    ASSERT_THAT(Append(cut, payload_, 0, 500), IsOk());
  }
  ScanIntake intake(environment_, std::stop_source());
  ASSERT_THAT(intake.Begin(DescriptionOf(cloud_)), IsOk());
  EXPECT_EQ(intake.committed_offset(), 500);
  EXPECT_TRUE(MetricsHave("curvereg_uploads_resumed_total 1"));
  ASSERT_THAT(Append(intake, payload_, 500, 600), IsOk());
  ASSERT_THAT(Append(intake, payload_, 1100, 100), IsOk());
  const auto committed = intake.Finish(DigestOf(payload_));
  ASSERT_THAT(committed, IsOk());
  EXPECT_EQ(committed->scan.finite_point_count, 100);
  EXPECT_EQ(StoredPayload(committed->scan.id), payload_);
}

TEST_F(ScanIntakeTest, KnowsAStoredScanByItsDigest) {
  ASSERT_THAT(Store(*store_, DescriptionOf(cloud_, "before"), payload_), IsOk());
  ScanIntake intake(environment_, std::stop_source());
  const auto known = intake.Begin(DescriptionOf(cloud_));
  ASSERT_THAT(known, IsOk());
  ASSERT_TRUE(known->has_value());
  EXPECT_EQ((*known)->id, ScanId(cloud_.header(), DigestOf(payload_)));
  EXPECT_TRUE(intake.has_begun());
  EXPECT_TRUE(intake.is_complete());
  EXPECT_EQ(ReasonOfUpload(), "UPLOAD_NOT_FOUND");
}

TEST_F(ScanIntakeTest, ChunksOfAStoredScanAreCheckedAndLeftOut) {
  ScanIntake intake(environment_, std::stop_source());
  intake.BeginStored(DescriptionOf(cloud_));
  EXPECT_EQ(intake.committed_offset(), 1200);
  EXPECT_THAT(Append(intake, payload_, 300, 600, Overlap::kSkip), IsOk());
  std::string damaged = payload_;
  damaged[700] ^= 1;
  const std::string_view data = std::string_view(damaged).substr(600, 600);
  const absl::Status status = intake.Append(
      {600, {&data, 1}, wire::Crc32c(std::string_view(payload_).substr(600, 600)), wire::Crc32c(data)}, Overlap::kSkip);
  EXPECT_THAT(status, HasReason(v1::ERROR_REASON_CHECKSUM_MISMATCH));
  EXPECT_TRUE(MetricsHave("curvereg_checksum_failures_total 1"));
  EXPECT_EQ(store_->Statistics().num_uploads, 0);
}

TEST_F(ScanIntakeTest, KnownBytesAreAnErrorOrLeftOut) {
  ScanIntake intake(environment_, std::stop_source());
  ASSERT_THAT(intake.Begin(DescriptionOf(cloud_)), IsOk());
  ASSERT_THAT(Append(intake, payload_, 0, 500), IsOk());
  const absl::Status refused = Append(intake, payload_, 400, 300);
  EXPECT_THAT(refused, HasReason(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE));
  EXPECT_EQ(MetadataOf(refused, "committed_offset"), "500");
  EXPECT_EQ(intake.committed_offset(), 500);
  EXPECT_THAT(Append(intake, payload_, 100, 400, Overlap::kSkip), IsOk());
  EXPECT_EQ(intake.committed_offset(), 500);
  EXPECT_THAT(Append(intake, payload_, 400, 300, Overlap::kSkip), IsOk());
  EXPECT_EQ(intake.committed_offset(), 700);
  ASSERT_THAT(Append(intake, payload_, 700, 500, Overlap::kSkip), IsOk());
  const auto committed = intake.Finish(DigestOf(payload_));
  ASSERT_THAT(committed, IsOk());
  EXPECT_EQ(StoredPayload(committed->scan.id), payload_);
}

TEST_F(ScanIntakeTest, TheKnownBytesMayEndWithinAnyPiece) {
  const std::string_view payload = payload_;
  for (const uint64_t num_known :
       {uint64_t{0}, uint64_t{1}, uint64_t{99}, uint64_t{100}, uint64_t{101}, uint64_t{399}}) {
    SCOPED_TRACE(num_known);
    ScanIntake intake(environment_, std::stop_source());
    ASSERT_THAT(intake.Begin(DescriptionOf(cloud_, "known-" + std::to_string(num_known))), IsOk());
    if (num_known > 0) {
      ASSERT_THAT(Append(intake, payload_, 0, num_known), IsOk());
    }
    const std::vector<std::string_view> pieces = {payload.substr(0, 100), payload.substr(100, 1),
                                                  payload.substr(101, 299)};
    const uint32_t crc32c = wire::Crc32c(payload.substr(0, 400));
    ASSERT_THAT(intake.Append({0, pieces, crc32c, crc32c}, Overlap::kSkip), IsOk());
    EXPECT_EQ(intake.committed_offset(), 400);
    ASSERT_THAT(Append(intake, payload_, 400, 600), IsOk());
    ASSERT_THAT(Append(intake, payload_, 1000, 200), IsOk());
    const auto committed = intake.Finish(DigestOf(payload_));
    ASSERT_THAT(committed, IsOk());
    EXPECT_EQ(StoredPayload(committed->scan.id), payload_);
    ASSERT_THAT(store_->DeleteScan(committed->scan.id), IsOk());
  }
}

TEST_F(ScanIntakeTest, RefusesAWrongChunkAndKeepsWhatWasThere) {
  ScanIntake intake(environment_, std::stop_source());
  ASSERT_THAT(intake.Begin(DescriptionOf(cloud_)), IsOk());
  ASSERT_THAT(Append(intake, payload_, 0, 500), IsOk());
  const std::string_view data = std::string_view(payload_).substr(500, 10);
  const uint32_t crc32c = wire::Crc32c(data);
  for (const Overlap overlap : {Overlap::kRefuse, Overlap::kSkip}) {
    const absl::Status gap = intake.Append({501, {&data, 1}, crc32c, crc32c}, overlap);
    EXPECT_THAT(gap, HasReason(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE));
    EXPECT_EQ(MetadataOf(gap, "committed_offset"), "500");
    EXPECT_THAT(intake.Append({500, {&data, 1}, crc32c ^ 1U, crc32c}, overlap),
                HasReason(v1::ERROR_REASON_CHECKSUM_MISMATCH));
    const absl::Status without_crc = intake.Append({500, {&data, 1}, std::nullopt, crc32c}, overlap);
    EXPECT_THAT(without_crc.message(), HasSubstr("chunk.crc32c"));
    EXPECT_THAT(without_crc, HasReason(v1::ERROR_REASON_INVALID_FIELD));
    EXPECT_THAT(intake.Append({500, {}, 0U, 0}, overlap), HasReason(v1::ERROR_REASON_INVALID_FIELD)) << "empty";
    EXPECT_THAT(Append(intake, payload_, 500, 601, overlap), HasReason(v1::ERROR_REASON_INVALID_FIELD)) << "too large";
    EXPECT_THAT(Append(intake, payload_ + "more", 700, 504, overlap), HasReason(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE));
  }
  const absl::Status beyond = [&] {
    EXPECT_THAT(Append(intake, payload_, 500, 500), IsOk());
    return Append(intake, payload_ + "more", 1000, 204);
  }();
  EXPECT_THAT(beyond, HasReason(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE));
  EXPECT_EQ(MetadataOf(beyond, "committed_offset"), "1000");
  EXPECT_EQ(store_->GetUpload("a")->committed_offset, 1000);
}

TEST_F(ScanIntakeTest, NeedsAllBytesToFinish) {
  ScanIntake intake(environment_, std::stop_source());
  ASSERT_THAT(intake.Begin(DescriptionOf(cloud_)), IsOk());
  ASSERT_THAT(Append(intake, payload_, 0, 500), IsOk());
  const absl::Status early = intake.Finish(DigestOf(payload_)).status();
  EXPECT_THAT(early, HasReason(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE));
  EXPECT_EQ(MetadataOf(early, "committed_offset"), "500");
  EXPECT_EQ(store_->GetUpload("a")->committed_offset, 500);
}

TEST_F(ScanIntakeTest, DiscardsAPayloadOfAnotherDigest) {
  for (const v1::Digest& declared : {DigestOf("other"), testing::Sha256("other")}) {
    ScanIntake intake(environment_, std::stop_source());
    UploadDescription description = DescriptionOf(cloud_);
    description.payload_digest.reset();
    ASSERT_THAT(intake.Begin(std::move(description)), IsOk());
    ASSERT_THAT(Append(intake, payload_, 0, 600), IsOk());
    ASSERT_THAT(Append(intake, payload_, 600, 600), IsOk());
    EXPECT_THAT(intake.Finish(declared), HasReason(v1::ERROR_REASON_DIGEST_MISMATCH));
    EXPECT_EQ(ReasonOfUpload(), "UPLOAD_NOT_FOUND");
  }
  EXPECT_TRUE(MetricsHave("curvereg_checksum_failures_total 2"));
  EXPECT_EQ(memory_.reserved_bytes(), 0);
}

TEST_F(ScanIntakeTest, DiscardsAPayloadThatDoesNotDecode) {
  v1::PointCloud cloud = cloud_;
  cloud.mutable_header()->set_encoding(v1::POINT_ENCODING_SHUFFLED_ZSTD);
  ScanIntake intake(environment_, std::stop_source());
  ASSERT_THAT(intake.Begin(DescriptionOf(cloud)), IsOk());
  ASSERT_THAT(Append(intake, payload_, 0, 600), IsOk());
  ASSERT_THAT(Append(intake, payload_, 600, 600), IsOk());
  EXPECT_THAT(intake.Finish(DigestOf(payload_)), HasReason(v1::ERROR_REASON_MALFORMED_PAYLOAD));
  EXPECT_EQ(ReasonOfUpload(), "UPLOAD_NOT_FOUND");
  EXPECT_EQ(memory_.reserved_bytes(), 0);
}

TEST_F(ScanIntakeTest, RefusesAtOnceWhatTheServerCouldNeverDecode) {
  MemoryBudget small(1000);
  UploadEnvironment environment = Environment();
  environment.memory = &small;
  ScanIntake intake(environment, std::stop_source());
  const absl::Status status = intake.Begin(DescriptionOf(cloud_)).status();
  EXPECT_THAT(status, HasReason(v1::ERROR_REASON_SCAN_TOO_LARGE));
  EXPECT_EQ(MetadataOf(status, "limit"), "1000");
  EXPECT_EQ(ReasonOfUpload(), "UPLOAD_NOT_FOUND");
}

TEST_F(ScanIntakeTest, ALaterOneTakesTheUploadOver) {
  const std::stop_source replaced;
  ScanIntake first(environment_, replaced);
  ASSERT_THAT(first.Begin(DescriptionOf(cloud_)), IsOk());
  ASSERT_THAT(Append(first, payload_, 0, 500), IsOk());
  ScanIntake second(environment_, std::stop_source());
  ASSERT_THAT(second.Begin(DescriptionOf(cloud_)), IsOk());
  EXPECT_TRUE(replaced.stop_requested());
  EXPECT_EQ(second.committed_offset(), 500);
  EXPECT_THAT(Append(first, payload_, 500, 10), HasReason(v1::ERROR_REASON_WRITER_REPLACED));
  EXPECT_THAT(Append(second, payload_, 500, 10), IsOk());
}

TEST_F(ScanIntakeTest, IsNotStoppedByAnotherUploadAfterItsEnd) {
  const std::stop_source replaced;
  ScanIntake intake(environment_, replaced);
  ASSERT_THAT(intake.Begin(DescriptionOf(cloud_)), IsOk());
  ASSERT_THAT(Append(intake, payload_, 0, 600), IsOk());
  ASSERT_THAT(Append(intake, payload_, 600, 600), IsOk());
  ASSERT_THAT(intake.Finish(DigestOf(payload_)), IsOk());
  const v1::PointCloud other = RandomCloud(10, 2);
  ScanIntake next(environment_, std::stop_source());
  ASSERT_THAT(next.Begin(DescriptionOf(other)), IsOk());
  EXPECT_FALSE(replaced.stop_requested());
}

}  // namespace
}  // namespace curvereg::server
