// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/lzf.h"

#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "tests/testing/corrupt_files.h"

namespace curvereg {
namespace {

using namespace std::string_view_literals;

absl::StatusOr<std::string> Decompress(std::string_view compressed, std::size_t size) {
  return testing::ParseExact([size](std::string_view bytes) { return LzfDecompress(bytes, size); }, compressed);
}

TEST(LzfTest, CopiesLiterals) {
  EXPECT_EQ(Decompress("\x02"
                       "abc"
                       "\x00"
                       "d"sv,
                       4)
                .value(),
            "abcd");
  EXPECT_EQ(Decompress("", 0).value(), "");
}

TEST(LzfTest, CopiesFromBehind) {
  // "abc", then 3 bytes (1 << 5) from 3 back (distance byte 2).
  EXPECT_EQ(Decompress("\x02"
                       "abc\x20\x02"sv,
                       6)
                .value(),
            "abcabc");
}

TEST(LzfTest, CopiesOverItsOwnOutput) {
  // "a", then 7 + 2 + 255 bytes from 1 back: the longest copy there is.
  const auto run = Decompress(
      "\x00"
      "a\xe0\xff\x00"sv,
      265);
  EXPECT_EQ(run.value(), std::string(265, 'a'));
}

TEST(LzfTest, CopiesFromFarBehind) {
  // 300 literal bytes in runs of 30, then 3 bytes from 300 back: 299 = (1 << 8) + 43.
  std::string literals;
  std::string compressed;
  for (int run = 0; run < 10; ++run) {
    const std::string piece(30, static_cast<char>('a' + run));
    literals += piece;
    compressed += '\x1d' + piece;
  }
  compressed += "\x21\x2b"sv;
  EXPECT_EQ(Decompress(compressed, 303).value(), literals + "aaa");
}

TEST(LzfTest, RefusesCorruptData) {
  const auto is_refused = [](std::string_view compressed, std::size_t size) {
    return absl::IsDataLoss(Decompress(compressed, size).status());
  };
  EXPECT_TRUE(
      is_refused("\x02"
                 "ab"sv,
                 3));                        // literals missing
  EXPECT_TRUE(is_refused("\x20\x00"sv, 3));  // from before the start
  EXPECT_TRUE(
      is_refused("\x00"
                 "a\x20"sv,
                 4));  // distance missing
  EXPECT_TRUE(
      is_refused("\x00"
                 "a\xe0\x05"sv,
                 15));  // distance missing after a length byte
  EXPECT_TRUE(
      is_refused("\x02"
                 "abc"sv,
                 2));  // more than declared
  EXPECT_TRUE(
      is_refused("\x02"
                 "abc"sv,
                 4));  // less than declared
  EXPECT_TRUE(
      is_refused("\x00"
                 "a\xe0\xff\x00"sv,
                 100));  // a copy beyond what is declared
  EXPECT_TRUE(is_refused("", 1));
  // Never reserved on the header's word.
  EXPECT_TRUE(
      is_refused("\x02"
                 "abc"sv,
                 std::size_t{1} << 60));
}

}  // namespace
}  // namespace curvereg
