// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/byte_shuffle.h"

#include <gtest/gtest.h>

#include <string>

namespace curvereg::wire {
namespace {

std::string Shuffled(std::string_view points, size_t stride) {
  std::string planes(points.size(), '?');
  ShuffleBytes(points, stride, planes.data());
  return planes;
}

TEST(ByteShuffleTest, PutsBytesOfLikeMeaningSideBySide) {
  EXPECT_EQ(Shuffled("abcABC123...", 3), "aA1.bB2.cC3.");
  EXPECT_EQ(Shuffled("abc", 1), "abc");
  EXPECT_EQ(Shuffled("abc", 3), "abc");
  EXPECT_EQ(Shuffled("", 12), "");
}

TEST(ByteShuffleTest, UnshufflingGivesTheBytesBack) {
  for (const size_t stride : {1U, 2U, 7U, 12U, 1024U}) {
    for (const size_t num_points : {0U, 1U, 255U, 256U, 257U, 1000U}) {
      std::string points(stride * num_points, '\0');
      for (size_t i = 0; i < points.size(); ++i) points[i] = static_cast<char>((i * 2654435761U) >> 11);
      const std::string planes = Shuffled(points, stride);
      for (size_t i = 0; i < points.size(); ++i) {
        ASSERT_EQ(planes[i % stride * num_points + i / stride], points[i]);
      }
      std::string back(points.size(), '?');
      UnshuffleBytes(planes, stride, back.data());
      EXPECT_EQ(back, points) << num_points << " points of " << stride << " bytes";
    }
  }
}

}  // namespace
}  // namespace curvereg::wire
