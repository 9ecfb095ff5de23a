// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/status_mapping.h"

#include <chrono>
#include <string>
#include <vector>

#include "google/rpc/status.pb.h"
#include "tests/testing/matchers.h"
#include "wire/error.h"

namespace curvereg::wire {
namespace {

using ::curvereg::testing::IsOk;

google::rpc::Status DetailsOf(const grpc::Status& status) {
  google::rpc::Status details;
  EXPECT_TRUE(details.ParseFromString(status.error_details()));
  return details;
}

template <typename Detail>
std::vector<Detail> DetailsOfType(const grpc::Status& status) {
  std::vector<Detail> found;
  const google::rpc::Status details = DetailsOf(status);
  for (const google::protobuf::Any& any : details.details()) {
    Detail detail;
    if (any.Is<Detail>() && any.UnpackTo(&detail)) found.push_back(detail);
  }
  return found;
}

// The reason that a caller sees; fails unless there is exactly one ErrorInfo, of our domain.
std::string SentReason(const absl::Status& status) {
  const auto infos = DetailsOfType<google::rpc::ErrorInfo>(ToGrpcStatus(status, "request-1"));
  EXPECT_EQ(infos.size(), 1U);
  if (infos.size() != 1) return "";
  EXPECT_EQ(infos[0].domain(), "curvereg");
  return infos[0].reason();
}

TEST(StatusMappingTest, OkIsOk) {
  EXPECT_TRUE(ToGrpcStatus(absl::OkStatus(), "request-1").ok());
  EXPECT_THAT(FromGrpcStatus(grpc::Status::OK), IsOk());
}

TEST(StatusMappingTest, EveryReasonIsSentOnceWithItsCode) {
  for (int i = v1::ErrorReason_MIN + 1; i <= v1::ErrorReason_MAX; ++i) {
    const auto reason = static_cast<v1::ErrorReason>(i);
    const absl::Status error = MakeError(reason, "text");
    EXPECT_EQ(SentReason(error), ReasonName(reason));
    const grpc::Status sent = ToGrpcStatus(error, "request-1");
    EXPECT_EQ(static_cast<int>(sent.error_code()), static_cast<int>(ReasonCode(reason)));
    EXPECT_EQ(DetailsOf(sent).code(), static_cast<int>(sent.error_code()));
    EXPECT_EQ(DetailsOf(sent).message(), sent.error_message());
  }
}

// Errors of the core, of libraries, and of foreign services carry no reason of ours.
TEST(StatusMappingTest, EveryCodeWithoutAReasonGetsOne) {
  for (int code = 1; code <= 16; ++code) {
    const absl::Status plain(static_cast<absl::StatusCode>(code), "text");
    const std::string reason = SentReason(plain);
    switch (plain.code()) {
      case absl::StatusCode::kInvalidArgument:
        EXPECT_EQ(reason, "UNUSABLE_SCAN");
        break;
      case absl::StatusCode::kUnimplemented:
        EXPECT_EQ(reason, "METHOD_UNAVAILABLE");
        break;
      case absl::StatusCode::kCancelled:
        EXPECT_EQ(reason, "CANCELLED");
        break;
      case absl::StatusCode::kDeadlineExceeded:
        EXPECT_EQ(reason, "DEADLINE_EXCEEDED");
        break;
      default:
        EXPECT_EQ(reason, "INTERNAL");
        EXPECT_EQ(ToGrpcStatus(plain, "").error_code(), grpc::StatusCode::INTERNAL);
    }
  }
}

TEST(StatusMappingTest, ForeignErrorInfoIsReplaced) {
  google::rpc::ErrorInfo foreign;
  foreign.set_reason("RATE_LIMIT");
  foreign.set_domain("example.com");
  google::rpc::ErrorInfo unknown;
  unknown.set_reason("NO_SUCH_REASON");
  unknown.set_domain(kErrorDomain);
  for (const google::rpc::ErrorInfo& info : {foreign, unknown}) {
    absl::Status error = absl::InvalidArgumentError("text");
    error.SetPayload("type.googleapis.com/google.rpc.ErrorInfo", absl::Cord(info.SerializeAsString()));
    EXPECT_EQ(SentReason(error), "UNUSABLE_SCAN");
  }
}

TEST(StatusMappingTest, DetailsTravelAlong) {
  const absl::Status busy =
      WithRetryDelay(MakeError(v1::ERROR_REASON_QUEUE_FULL, "busy"), std::chrono::milliseconds(1250));
  const grpc::Status sent = ToGrpcStatus(busy, "request-1");
  const auto retry = DetailsOfType<google::rpc::RetryInfo>(sent);
  ASSERT_EQ(retry.size(), 1U);
  EXPECT_EQ(retry[0].retry_delay().seconds(), 1);
  EXPECT_EQ(retry[0].retry_delay().nanos(), 250'000'000);
  const auto request = DetailsOfType<google::rpc::RequestInfo>(sent);
  ASSERT_EQ(request.size(), 1U);
  EXPECT_EQ(request[0].request_id(), "request-1");
  EXPECT_TRUE(DetailsOfType<google::rpc::RequestInfo>(ToGrpcStatus(busy, "")).empty());
}

TEST(StatusMappingTest, ErrorsComeBackOnTheOtherSide) {
  const absl::Status error = WithinField("source", FieldError("inline_scan", "missing"));
  const absl::Status back = FromGrpcStatus(ToGrpcStatus(error, "request-1"));
  EXPECT_EQ(back.code(), error.code());
  EXPECT_EQ(back.message(), error.message());
  EXPECT_EQ(ReasonOf(back), v1::ERROR_REASON_INVALID_FIELD);
  ASSERT_TRUE(BadRequestOf(back).has_value());
  EXPECT_EQ(BadRequestOf(back)->field_violations(0).field(), "source.inline_scan");
}

TEST(StatusMappingTest, InternalMessagesStayInside) {
  for (const absl::Status& error :
       {absl::InternalError("secret"), MakeError(v1::ERROR_REASON_INTERNAL, "secret"), absl::UnknownError("secret")}) {
    const grpc::Status sent = ToGrpcStatus(error, "request-1");
    EXPECT_EQ(sent.error_message().find("secret"), std::string::npos);
    EXPECT_EQ(sent.error_details().find("secret"), std::string::npos);
    EXPECT_FALSE(sent.error_message().empty());
  }
}

TEST(StatusMappingTest, LongMessagesAreCutBetweenCharacters) {
  const grpc::Status plain = ToGrpcStatus(MakeError(v1::ERROR_REASON_UNUSABLE_SCAN, std::string(5000, 'a')), "");
  EXPECT_EQ(plain.error_message().size(), 1024U);
  std::string umlauts = "a";  // so that the limit falls within a character of two bytes
  for (int i = 0; i < 2000; ++i) umlauts += "\xC3\xA4";
  const std::string cut = ToGrpcStatus(MakeError(v1::ERROR_REASON_UNUSABLE_SCAN, umlauts), "").error_message();
  EXPECT_EQ(cut.size(), 1023U);
  EXPECT_EQ(cut, umlauts.substr(0, 1023));
  const std::string at_limit(1024, 'b');
  EXPECT_EQ(ToGrpcStatus(MakeError(v1::ERROR_REASON_UNUSABLE_SCAN, at_limit), "").error_message(), at_limit);
}

TEST(StatusMappingTest, DetailsThatDoNotParseAreLeftOut) {
  const absl::Status error = FromGrpcStatus({grpc::StatusCode::UNAVAILABLE, "gone", "\xFF not a message"});
  EXPECT_EQ(error.code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(error.message(), "gone");
  EXPECT_FALSE(ErrorInfoOf(error).has_value());
}

}  // namespace
}  // namespace curvereg::wire
