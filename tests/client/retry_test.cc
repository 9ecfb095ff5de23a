// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/retry.h"

#include <chrono>
#include <optional>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wire/error.h"

namespace curvereg::internal {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

const absl::Status kLost = absl::UnavailableError("lost");

absl::Status Busy(milliseconds delay) {
  return wire::WithRetryDelay(wire::MakeError(v1::ERROR_REASON_QUEUE_FULL, "busy"), delay);
}

TEST(IsRetryableTest, OnlyWhatIsSafe) {
  EXPECT_TRUE(IsRetryable(kLost));
  EXPECT_TRUE(IsRetryable(wire::MakeError(v1::ERROR_REASON_NOT_SERVING, "stopping")));
  EXPECT_TRUE(IsRetryable(Busy(milliseconds(1))));
  EXPECT_FALSE(IsRetryable(wire::MakeError(v1::ERROR_REASON_STORAGE_FULL, "full")));
  EXPECT_TRUE(IsRetryable(absl::ResourceExhaustedError("Received RST_STREAM with error code 11")));
  EXPECT_FALSE(IsRetryable(absl::ResourceExhaustedError("Received message larger than max (5300015 vs. 4194304)")));
  EXPECT_FALSE(IsRetryable(wire::MakeError(v1::ERROR_REASON_SCAN_TOO_LARGE, "Received RST_STREAM with error code 11")));
  EXPECT_FALSE(IsRetryable(wire::MakeError(v1::ERROR_REASON_WRITER_REPLACED, "other")));
  EXPECT_FALSE(IsRetryable(wire::MakeError(v1::ERROR_REASON_DEADLINE_EXCEEDED, "late")));
  EXPECT_FALSE(IsRetryable(wire::MakeError(v1::ERROR_REASON_CHECKSUM_MISMATCH, "damaged")));
  EXPECT_FALSE(IsRetryable(absl::InternalError("bad")));
  EXPECT_TRUE(IsRetryable(absl::CancelledError("by a server that ended")));
  EXPECT_FALSE(IsRetryable(wire::MakeError(v1::ERROR_REASON_CANCELLED, "by the caller")));
  EXPECT_FALSE(IsRetryable(absl::OkStatus()));
}

TEST(IsResumableTest, AddsDamageOnTheWay) {
  EXPECT_TRUE(IsResumable(kLost));
  EXPECT_TRUE(IsResumable(wire::MakeError(v1::ERROR_REASON_CHECKSUM_MISMATCH, "damaged")));
  EXPECT_TRUE(IsResumable(wire::MakeError(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE, "gap")));
  EXPECT_TRUE(IsResumable(absl::InternalError("unparsable message")));
  EXPECT_FALSE(IsResumable(wire::MakeError(v1::ERROR_REASON_INTERNAL, "a fault of the server")));
  EXPECT_FALSE(IsResumable(wire::MakeError(v1::ERROR_REASON_WRITER_REPLACED, "other")));
  EXPECT_FALSE(IsResumable(wire::MakeError(v1::ERROR_REASON_DIGEST_MISMATCH, "wrong")));
  EXPECT_FALSE(IsResumable(wire::MakeError(v1::ERROR_REASON_CANCELLED, "user")));
  EXPECT_TRUE(IsRetryable(absl::CancelledError("by gRPC, when a server ends")));
}

TEST(BackoffTest, DoublesUpToTheGreatestDelay) {
  Backoff backoff({.max_attempts = 6, .initial_backoff = milliseconds(100), .max_backoff = milliseconds(350)});
  // A jitter of one half gives the delay itself.
  EXPECT_EQ(backoff.NextDelay(kLost, 0.5), milliseconds(100));
  EXPECT_EQ(backoff.NextDelay(kLost, 0.5), milliseconds(200));
  EXPECT_EQ(backoff.NextDelay(kLost, 0.5), milliseconds(350));
  EXPECT_EQ(backoff.NextDelay(kLost, 0.5), milliseconds(350));
  EXPECT_EQ(backoff.NextDelay(kLost, 0.5), milliseconds(350));
  EXPECT_EQ(backoff.NextDelay(kLost, 0.5), std::nullopt);
}

TEST(BackoffTest, DrawsWithinAFifth) {
  const RetryOptions options{.initial_backoff = milliseconds(1000)};
  EXPECT_EQ(Backoff(options).NextDelay(kLost, 0.0), milliseconds(800));
  EXPECT_NEAR(static_cast<double>(Backoff(options).NextDelay(kLost, 1.0)->count()), 1200.0, 1.0);
}

TEST(BackoffTest, KeepsTheServersDelay) {
  const RetryOptions options{.initial_backoff = milliseconds(100), .max_backoff = milliseconds(1000)};
  EXPECT_EQ(Backoff(options).NextDelay(Busy(milliseconds(5000)), 0.5), milliseconds(5025));  // a longer one
  EXPECT_EQ(Backoff(options).NextDelay(Busy(milliseconds(10)), 0.5), milliseconds(100));     // not a shorter one
}

TEST(BackoffTest, StartsAgainAfterProgress) {
  Backoff backoff({.max_attempts = 2, .initial_backoff = milliseconds(100)});
  EXPECT_TRUE(backoff.NextDelay(kLost, 0.5).has_value());
  backoff.Restart();
  EXPECT_EQ(backoff.NextDelay(kLost, 0.5), milliseconds(100));
  EXPECT_FALSE(backoff.NextDelay(kLost, 0.5).has_value());
}

TEST(BackoffTest, OneAttemptIsOneAttempt) {
  EXPECT_FALSE(Backoff({.max_attempts = 1}).NextDelay(kLost, 0.5).has_value());
}

TEST(BackoffTest, RefusalsDoNotCount) {
  const absl::Status refused = wire::MakeError(v1::ERROR_REASON_NOT_SERVING, "stopping");
  Backoff backoff({.max_attempts = 2, .initial_backoff = milliseconds(100), .max_backoff = milliseconds(350)});
  EXPECT_EQ(backoff.NextDelay(refused, 0.5), milliseconds(100));
  EXPECT_EQ(backoff.NextDelay(refused, 0.5), milliseconds(200));
  for (int i = 0; i < 20; ++i) EXPECT_EQ(backoff.NextDelay(refused, 0.5), milliseconds(350));
  EXPECT_TRUE(backoff.NextDelay(kLost, 0.5).has_value()) << "the first that counts";
  EXPECT_FALSE(backoff.NextDelay(kLost, 0.5).has_value());
  EXPECT_FALSE(Backoff({.max_attempts = 1}).NextDelay(refused, 0.5).has_value());
}

TEST(SleepForTest, SleepsNoLongerThanAllowed) {
  Clock::time_point start = Clock::now();
  EXPECT_TRUE(SleepFor(milliseconds(30), {}).ok());
  EXPECT_GE(Clock::now() - start, milliseconds(30));
  start = Clock::now();
  EXPECT_TRUE(absl::IsDeadlineExceeded(SleepFor(milliseconds(5000), {{}, start + milliseconds(100)})));
  EXPECT_LT(Clock::now() - start, milliseconds(100)) << "there is no use in waiting for what comes too late";
}

TEST(SleepForTest, IsCutShortByCancellation) {
  std::stop_source source;
  const std::jthread canceller([&] {
    std::this_thread::sleep_for(milliseconds(30));
    source.request_stop();
  });
  const Clock::time_point start = Clock::now();
  EXPECT_TRUE(absl::IsCancelled(SleepFor(milliseconds(10'000), {source.get_token(), std::nullopt})));
  EXPECT_LT(Clock::now() - start, milliseconds(5000));
}

}  // namespace
}  // namespace curvereg::internal
