// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/preparation/registration_input.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/store/store_testing.h"
#include "tests/testing/scenes.h"
#include "wire/error.h"
#include "wire/point_codec.h"
#include "wire/resource_names.h"

namespace curvereg::server {
namespace {

using testing::HasCode;
using ::testing::HasSubstr;
using testing::IsOk;

Scan SmallScan() {
  Scan scan;
  scan.points = testing::PatchPoints({.side_m = 10.0, .noise_m = 0.02}, 500, 7);
  return scan;
}

// The one field that the error names; empty when it names none or several.
std::string FieldOf(const absl::Status& status) {
  const auto bad_request = wire::BadRequestOf(status);
  if (!bad_request.has_value() || bad_request->field_violations_size() != 1) return "";
  return bad_request->field_violations(0).field();
}

class RegistrationInputTest : public ::testing::Test {
 protected:
  std::string Keep(const v1::PointCloud& cloud) {
    const auto stored =
        Store(*store_, {"upload", cloud.header(), cloud.data().size(), DigestOf(cloud.data())}, cloud.data());
    EXPECT_THAT(stored, IsOk());
    return stored.ok() ? stored->scan.id : "";
  }
  v1::ScanInput Inline(const v1::PointCloud& cloud) {
    v1::ScanInput input;
    *input.mutable_inline_scan() = cloud;
    return input;
  }
  absl::StatusOr<RegistrationInput> Find(const v1::ScanInput& input) {
    return RegistrationInput::Find(input, "source", sources_);
  }
  absl::StatusOr<RegistrationInput> FindByName(const std::string& name) {
    v1::ScanInput input;
    input.set_name(name);
    return Find(input);
  }

  testing::TemporaryFolder folder_;
  std::unique_ptr<ScanStore> store_ = OpenStore(folder_.path());
  MemoryBudget memory_{uint64_t{1} << 30};
  PreparedScanCache cache_{uint64_t{64} << 20};
  Metrics metrics_;
  ScanSources sources_ = {
      .limits = {}, .memory = &memory_, .cache = &cache_, .store = store_.get(), .metrics = &metrics_};
  const Scan scan_ = SmallScan();
  const v1::PointCloud cloud_ = *wire::EncodeScan(scan_);
};

TEST_F(RegistrationInputTest, AStoredScanIsTheSameByIdAndByName) {
  const std::string id = Keep(cloud_);
  const auto by_id = RegistrationInput::OfStored(id, "source", sources_);
  const auto by_name = FindByName(wire::ScanName(id));
  for (const auto* input : {&by_id, &by_name}) {
    ASSERT_THAT(*input, IsOk());
    EXPECT_TRUE((*input)->is_stored());
    EXPECT_EQ((*input)->num_points(), 500U);
    const auto scan = (*input)->Decode();
    ASSERT_THAT(scan, IsOk());
    EXPECT_TRUE((*scan)->points == scan_.points);
  }
  EXPECT_EQ(by_id->MemoryBytes(), by_name->MemoryBytes());
}

TEST_F(RegistrationInputTest, AnInlineScanIsDecodedAndCounted) {
  const v1::ScanInput input = Inline(cloud_);
  const auto found = Find(input);
  ASSERT_THAT(found, IsOk());
  EXPECT_FALSE(found->is_stored());
  EXPECT_EQ(found->num_points(), 500U);
  const auto scan = found->Decode();
  ASSERT_THAT(scan, IsOk());
  EXPECT_TRUE((*scan)->points == scan_.points);
  EXPECT_THAT(metrics_.Text(), HasSubstr("\ncurvereg_received_points_total 500\n"));
}

TEST_F(RegistrationInputTest, MemoryIsThatOfPayloadPointsAndPreparation) {
  const uint64_t decoding = wire::DecodingBytes(cloud_.header());
  const v1::ScanInput input = Inline(cloud_);
  const auto inline_scan = Find(input);
  ASSERT_THAT(inline_scan, IsOk());
  EXPECT_EQ(inline_scan->DecodingBytes(), decoding) << "its payload is there already";
  EXPECT_EQ(inline_scan->MemoryBytes(), decoding + PreparationBytes(500));
  const auto stored = RegistrationInput::OfStored(Keep(cloud_), "source", sources_);
  ASSERT_THAT(stored, IsOk());
  EXPECT_EQ(stored->DecodingBytes(), decoding + cloud_.data().size());
  EXPECT_EQ(stored->MemoryBytes(), decoding + cloud_.data().size() + PreparationBytes(500));
}

TEST_F(RegistrationInputTest, AStoredScanIsPreparedOnceAndThenCostsLittle) {
  const std::string id = Keep(cloud_);
  const auto first = RegistrationInput::OfStored(id, "source", sources_)->Prepare({});
  ASSERT_THAT(first, IsOk());
  const auto again = RegistrationInput::OfStored(id, "source", sources_);
  ASSERT_THAT(again, IsOk());
  EXPECT_EQ(again->DecodingBytes(), 0U);
  EXPECT_EQ(again->MemoryBytes(), PreparationBytes(0));
  EXPECT_EQ(again->num_points(), 500U);
  EXPECT_EQ(*again->Prepare({}), *first);
  EXPECT_EQ(*again->Decode(), std::shared_ptr<const Scan>(*first, &(*first)->scan()));
  EXPECT_EQ(cache_.GetStatistics().num_misses, 1U);
}

TEST_F(RegistrationInputTest, AnInlineScanIsNotKept) {
  const v1::ScanInput input = Inline(cloud_);
  ASSERT_THAT(Find(input)->Prepare({}), IsOk());
  EXPECT_EQ(cache_.GetStatistics().num_entries, 0U);
}

TEST_F(RegistrationInputTest, ErrorsNameTheField) {
  const absl::Status neither = Find({}).status();
  EXPECT_THAT(neither, HasReason(v1::ERROR_REASON_INVALID_FIELD));
  EXPECT_EQ(FieldOf(neither), "source");
  const absl::Status no_name = FindByName("scans/x").status();
  EXPECT_THAT(no_name, HasReason(v1::ERROR_REASON_INVALID_FIELD));
  EXPECT_EQ(FieldOf(no_name), "source.name");
  v1::PointCloud cloud = cloud_;
  cloud.mutable_header()->mutable_layout()->set_point_stride(0);
  const v1::ScanInput input = Inline(cloud);
  EXPECT_THAT(FieldOf(Find(input).status()), ::testing::StartsWith("source.inline_scan.header."));
}

TEST_F(RegistrationInputTest, ScansThatAreNotThereAreNotFound) {
  const std::string id(32, '0');
  EXPECT_THAT(RegistrationInput::OfStored(id, "source", sources_), HasReason(v1::ERROR_REASON_SCAN_NOT_FOUND));
  sources_.store = nullptr;
  const absl::Status no_store = RegistrationInput::OfStored(id, "source", sources_).status();
  EXPECT_THAT(no_store, HasReason(v1::ERROR_REASON_SCAN_NOT_FOUND));
  EXPECT_EQ(no_store.message(), "source: this server stores no scans");
}

TEST_F(RegistrationInputTest, NarrowerLimitsHoldForStoredScansToo) {
  const std::string id = Keep(cloud_);
  sources_.limits.max_scan_points = 499;
  EXPECT_THAT(RegistrationInput::OfStored(id, "source", sources_), HasReason(v1::ERROR_REASON_SCAN_TOO_LARGE));
  const v1::ScanInput input = Inline(cloud_);
  EXPECT_THAT(Find(input), HasReason(v1::ERROR_REASON_SCAN_TOO_LARGE));
  sources_.limits.max_scan_points = 500;
  EXPECT_THAT(Find(input), IsOk());
}

TEST_F(RegistrationInputTest, AScanThatCannotBePreparedIsUnusable) {
  Scan few;
  few.points = {{1.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F}};
  const v1::ScanInput input = Inline(*wire::EncodeScan(few));
  const auto found = Find(input);
  ASSERT_THAT(found, IsOk());
  const absl::Status status = found->Prepare({}).status();
  EXPECT_THAT(status, HasReason(v1::ERROR_REASON_UNUSABLE_SCAN));
  EXPECT_EQ(FieldOf(status), "source");
  const absl::Status other = absl::CancelledError("asked to stop");
  EXPECT_EQ(found->Named(other), other) << "only errors of the core about the scan are named";
}

TEST_F(RegistrationInputTest, DamageIsFoundWhenTheBytesAreRead) {
  const std::string id = Keep(cloud_);
  const std::string path = FilesBelow(folder_.File("payloads")).at(0);
  std::string bytes = ReadFile(path);
  bytes[0] = static_cast<char>(bytes[0] ^ 1);
  WriteFile(path, bytes);
  const auto found = RegistrationInput::OfStored(id, "source", sources_);
  ASSERT_THAT(found, IsOk());
  EXPECT_THAT(found->Decode(), HasReason(v1::ERROR_REASON_STORED_SCAN_DAMAGED));
}

TEST_F(RegistrationInputTest, StopsWhenAsked) {
  std::stop_source stop;
  stop.request_stop();
  const auto found = RegistrationInput::OfStored(Keep(cloud_), "source", sources_);
  ASSERT_THAT(found, IsOk());
  EXPECT_THAT(found->Prepare({stop.get_token(), {}}), HasCode(absl::StatusCode::kCancelled));
}

}  // namespace
}  // namespace curvereg::server
