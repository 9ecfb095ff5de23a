// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/hash.h"

#include <gtest/gtest.h>
#include <xxhash.h>

#include <string>

namespace curvereg {
namespace {

// xxHash's own functions for one instruction set, at lengths around the ends of its formulas.
TEST(HashTest, IsXxh3) {
  EXPECT_EQ(HashOf(""), 0x2D06800538D394C2U);
  std::string bytes;
  for (int i = 0; i < 5000; ++i) bytes.push_back(static_cast<char>(i * 31 % 251));
  for (const std::size_t size : {1, 3, 4, 8, 9, 16, 17, 128, 129, 240, 241, 1024, 5000}) {
    EXPECT_EQ(HashOf({bytes.data(), size}), XXH3_64bits(bytes.data(), size)) << size;
    EXPECT_EQ(HashOf({bytes.data(), size}, 7), XXH3_64bits_withSeed(bytes.data(), size, 7)) << size;
  }
}

}  // namespace
}  // namespace curvereg
