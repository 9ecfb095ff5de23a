// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/error.h"

#include <chrono>
#include <optional>
#include <string>

#include "tests/testing/matchers.h"

namespace curvereg::wire {
namespace {

using ::curvereg::testing::HasCode;
using std::chrono::milliseconds;

TEST(ErrorTest, NamesGoWithoutThePrefixAndComeBack) {
  EXPECT_EQ(ReasonName(v1::ERROR_REASON_QUEUE_FULL), "QUEUE_FULL");
  EXPECT_EQ(ReasonFromName("QUEUE_FULL"), v1::ERROR_REASON_QUEUE_FULL);
  for (int i = v1::ErrorReason_MIN; i <= v1::ErrorReason_MAX; ++i) {
    ASSERT_TRUE(v1::ErrorReason_IsValid(i)) << "the numbers have a gap at " << i;
    const auto reason = static_cast<v1::ErrorReason>(i);
    EXPECT_EQ(ReasonFromName(ReasonName(reason)), reason);
  }
}

TEST(ErrorTest, UnknownNamesAndNumbersAreNoReason) {
  for (const char* name : {"", "queue_full", "ERROR_REASON_QUEUE_FULL", "QUEUE_FULL ", "QUEUE"}) {
    EXPECT_EQ(ReasonFromName(name), std::nullopt) << name;
  }
  EXPECT_EQ(ReasonName(static_cast<v1::ErrorReason>(12345)), "UNSPECIFIED");
  EXPECT_EQ(ReasonCode(static_cast<v1::ErrorReason>(12345)), absl::StatusCode::kInternal);
}

TEST(ErrorTest, AnErrorCarriesReasonDomainAndMetadata) {
  const absl::Status error = MakeError(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE, "go back", {{"committed_offset", "7"}});
  EXPECT_THAT(error, HasCode(absl::StatusCode::kOutOfRange));
  EXPECT_EQ(error.message(), "go back");
  const auto info = ErrorInfoOf(error);
  ASSERT_TRUE(info.has_value());
  EXPECT_EQ(info->reason(), "OFFSET_OUT_OF_RANGE");
  EXPECT_EQ(info->domain(), "curvereg");
  ASSERT_EQ(info->metadata().size(), 1U);
  EXPECT_EQ(info->metadata().at("committed_offset"), "7");
  EXPECT_EQ(ReasonOf(error), v1::ERROR_REASON_OFFSET_OUT_OF_RANGE);
}

TEST(ErrorTest, FieldErrorsNameTheField) {
  const absl::Status error = FieldError("options.prior", "missing");
  EXPECT_EQ(ReasonOf(error), v1::ERROR_REASON_INVALID_FIELD);
  EXPECT_EQ(error.message(), "options.prior: missing");
  const auto bad_request = BadRequestOf(error);
  ASSERT_TRUE(bad_request.has_value());
  ASSERT_EQ(bad_request->field_violations_size(), 1);
  EXPECT_EQ(bad_request->field_violations(0).field(), "options.prior");
  EXPECT_EQ(bad_request->field_violations(0).description(), "missing");
}

TEST(ErrorTest, WithinPutsThePrefixBeforeTheField) {
  const absl::Status error =
      WithinField("source", WithinField("inline_scan", FieldError("header.layout", "has no field x")));
  EXPECT_EQ(error.message(), "source.inline_scan.header.layout: has no field x");
  EXPECT_EQ(BadRequestOf(error)->field_violations(0).field(), "source.inline_scan.header.layout");
  EXPECT_EQ(ReasonOf(error), v1::ERROR_REASON_INVALID_FIELD);
}

TEST(ErrorTest, WithinLeavesOtherErrorsAlone) {
  const absl::Status error = WithRetryDelay(MakeError(v1::ERROR_REASON_QUEUE_FULL, "busy"), milliseconds(5));
  EXPECT_EQ(WithinField("source", error), error);
  EXPECT_EQ(WithinField("source", absl::OkStatus()), absl::OkStatus());
}

TEST(ErrorTest, RetryDelaysComeBack) {
  for (const int64_t ms : {0, 1, 999, 1000, 1250, 3'600'001}) {
    const absl::Status error = WithRetryDelay(MakeError(v1::ERROR_REASON_MEMORY_BUDGET, "no memory"), milliseconds(ms));
    EXPECT_EQ(RetryDelayOf(error), milliseconds(ms));
    EXPECT_EQ(ReasonOf(error), v1::ERROR_REASON_MEMORY_BUDGET);
  }
  EXPECT_EQ(RetryDelayOf(MakeError(v1::ERROR_REASON_INTERNAL, "")), std::nullopt);
}

TEST(ErrorTest, RetryDelaysBeyondReasonAreBounded) {
  const auto delay_of = [](int64_t seconds, int32_t nanos) {
    google::rpc::RetryInfo info;
    info.mutable_retry_delay()->set_seconds(seconds);
    info.mutable_retry_delay()->set_nanos(nanos);
    absl::Status error = absl::ResourceExhaustedError("busy");
    error.SetPayload("type.googleapis.com/google.rpc.RetryInfo", absl::Cord(info.SerializeAsString()));
    return RetryDelayOf(error);
  };
  EXPECT_EQ(delay_of(INT64_MAX, 0), std::chrono::hours(24));
  EXPECT_EQ(delay_of(INT64_MIN, 0), milliseconds(0));
  EXPECT_EQ(delay_of(1, -500'000'000), milliseconds(1000));
  EXPECT_EQ(delay_of(0, INT32_MAX), milliseconds(999));
}

TEST(ErrorTest, PlainErrorsCarryNothing) {
  const absl::Status plain = absl::InvalidArgumentError("too few points");
  EXPECT_FALSE(ErrorInfoOf(plain).has_value());
  EXPECT_EQ(ReasonOf(plain), std::nullopt);
  EXPECT_FALSE(BadRequestOf(plain).has_value());
  EXPECT_EQ(RetryDelayOf(plain), std::nullopt);
}

TEST(ErrorTest, ReasonsOfOtherDomainsAreNotOurs) {
  google::rpc::ErrorInfo info;
  info.set_reason("QUEUE_FULL");
  info.set_domain("example.com");
  absl::Status error = absl::ResourceExhaustedError("another service's");
  error.SetPayload("type.googleapis.com/google.rpc.ErrorInfo", absl::Cord(info.SerializeAsString()));
  EXPECT_TRUE(ErrorInfoOf(error).has_value());
  EXPECT_EQ(ReasonOf(error), std::nullopt);
}

}  // namespace
}  // namespace curvereg::wire
