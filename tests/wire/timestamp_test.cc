// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/timestamp.h"

#include <gtest/gtest.h>

#include <limits>

namespace curvereg::wire {
namespace {

TEST(TimestampTest, RoundsDownSoThatNanosecondsAreNeverNegative) {
  EXPECT_EQ(TimestampOf(int64_t{1'500'000'001}).seconds(), 1);
  EXPECT_EQ(TimestampOf(int64_t{1'500'000'001}).nanos(), 500'000'001);
  EXPECT_EQ(TimestampOf(int64_t{-1}).seconds(), -1);
  EXPECT_EQ(TimestampOf(int64_t{-1}).nanos(), 999'999'999);
  EXPECT_EQ(TimestampOf(int64_t{-1'000'000'000}).seconds(), -1);
  EXPECT_EQ(TimestampOf(int64_t{-1'000'000'000}).nanos(), 0);
}

TEST(TimestampTest, ComesBack) {
  for (const int64_t time : {int64_t{0}, int64_t{-1}, int64_t{1'795'000'000'123'456'789}, int64_t{-5'000'000'001}}) {
    EXPECT_EQ(NanosecondsOf(TimestampOf(time)), time);
    EXPECT_EQ(TimestampOf(TimePointOf(time)).seconds(), TimestampOf(time).seconds());
  }
}

TEST(TimestampTest, RefusesWhat64BitsDoNotHold) {
  google::protobuf::Timestamp time;
  time.set_seconds(std::numeric_limits<int64_t>::max());
  EXPECT_EQ(NanosecondsOf(time), std::nullopt);
  time.set_seconds(std::numeric_limits<int64_t>::min());
  EXPECT_EQ(NanosecondsOf(time), std::nullopt);
  time.set_seconds(0);
  time.set_nanos(-1);
  EXPECT_EQ(NanosecondsOf(time), std::nullopt);
  time.set_nanos(1'000'000'000);
  EXPECT_EQ(NanosecondsOf(time), std::nullopt);
}

}  // namespace
}  // namespace curvereg::wire
