// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace curvereg::sim {
namespace {

TEST(RandomTest, KnownBits) {
  // SplitMix64 of state 0, as published with the generator.
  RandomStream random(0);
  EXPECT_EQ(random.Bits(), 0xe220a8397b1dcdafULL);
  EXPECT_EQ(random.Bits(), 0x6e789e6aa1b965f4ULL);
  EXPECT_EQ(random.Bits(), 0x06c45d188009454fULL);
}

TEST(RandomTest, MomentsOfUniformAndNormal) {
  constexpr int kCount = 200'000;
  double uniform_sum = 0.0;
  double normal_sum = 0.0;
  double normal_squares = 0.0;
  int beyond_two = 0;
  for (int i = 0; i < kCount; ++i) {
    // One draw per stream, as beams do: streams of neighbouring indices must be independent.
    RandomStream random(SubKey(7, static_cast<uint64_t>(i)));
    const double uniform = random.Uniform();
    ASSERT_GE(uniform, 0.0);
    ASSERT_LT(uniform, 1.0);
    uniform_sum += uniform;
    const double normal = random.Normal();
    normal_sum += normal;
    normal_squares += normal * normal;
    if (std::abs(normal) > 2.0) ++beyond_two;
  }
  EXPECT_NEAR(uniform_sum / kCount, 0.5, 0.003);
  EXPECT_NEAR(normal_sum / kCount, 0.0, 0.01);
  EXPECT_NEAR(normal_squares / kCount, 1.0, 0.015);
  EXPECT_NEAR(static_cast<double>(beyond_two) / kCount, 0.0455, 0.003);
}

TEST(RandomTest, SubKeysAreDistinct) {
  std::set<uint64_t> keys;
  for (uint64_t key = 0; key < 100; ++key) {
    for (uint64_t index = 0; index < 100; ++index) keys.insert(SubKey(key, index));
  }
  EXPECT_EQ(keys.size(), 10'000U);
}

}  // namespace
}  // namespace curvereg::sim
