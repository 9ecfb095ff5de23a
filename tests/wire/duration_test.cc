// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/duration.h"

#include <gtest/gtest.h>

#include "tests/wire/conversion_samples.h"

namespace curvereg::wire {
namespace {

TEST(DurationTest, DurationsKeepNanoseconds) {
  for (const double seconds : {0.0, 1e-9, 0.1, 1.999999999, 2.9999999999, 12345.678901234, -0.25, -3.0}) {
    const auto back = SecondsOf(ToWire(seconds));
    ASSERT_TRUE(back.has_value()) << seconds;
    EXPECT_NEAR(*back, seconds, 5.1e-10);
  }
  EXPECT_EQ(SecondsOf(ToWire(1e300)), 315'576'000'000.0);
  EXPECT_EQ(SecondsOf(ToWire(-kInfinity)), -315'576'000'000.0);
  EXPECT_EQ(SecondsOf(ToWire(kNan)), 0.0);
  google::protobuf::Duration mixed;
  mixed.set_seconds(1);
  mixed.set_nanos(-1);
  EXPECT_FALSE(SecondsOf(mixed).has_value());
}

}  // namespace
}  // namespace curvereg::wire
