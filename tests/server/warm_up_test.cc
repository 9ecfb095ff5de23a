// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/warm_up.h"

#include <gtest/gtest.h>

#include "tests/testing/matchers.h"

namespace curvereg::server {
namespace {

TEST(WarmUpTest, FindsTheMotionThatItMadeUp) { EXPECT_THAT(WarmUp(), testing::IsOk()); }

}  // namespace
}  // namespace curvereg::server
