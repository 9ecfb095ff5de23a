// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/stop_status.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/testing/matchers.h"

namespace curvereg {
namespace {

using testing::HasCode;
using testing::IsOk;

TEST(StopStatusTest, TellsCancelledFromLate) {
  EXPECT_THAT(StopStatus({}, "the map"), IsOk());
  const absl::Status late = StopStatus({{}, std::chrono::steady_clock::now()}, "the map");
  EXPECT_THAT(late, HasCode(absl::StatusCode::kDeadlineExceeded));
  EXPECT_EQ(late.message(), "the map ran out of time");
  std::stop_source source;
  source.request_stop();
  const absl::Status cancelled = StopStatus({source.get_token(), std::chrono::steady_clock::now()}, "the map");
  EXPECT_THAT(cancelled, HasCode(absl::StatusCode::kCancelled));
  EXPECT_EQ(cancelled.message(), "the map was cancelled");
}

}  // namespace
}  // namespace curvereg
