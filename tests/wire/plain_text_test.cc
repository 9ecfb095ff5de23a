// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/plain_text.h"

#include <gtest/gtest.h>

namespace curvereg::wire {
namespace {

TEST(PlainTextTest, TakesTextOfEveryLanguage) {
  for (const std::string_view text :
       {"", "os_lidar", "a b", "caf\u00E9", "\u0950", "\uFFFD", "\U0001F6F0", "\U0010FFFF", "\u00A0"}) {
    EXPECT_TRUE(IsPlainText(text)) << text;
  }
}

TEST(PlainTextTest, RefusesControlCharacters) {
  EXPECT_FALSE(IsPlainText("a\nb"));
  EXPECT_FALSE(IsPlainText("\x1B[31m"));
  EXPECT_FALSE(IsPlainText("\x7F"));
  EXPECT_FALSE(IsPlainText("\u0085"));
  EXPECT_FALSE(IsPlainText(std::string_view("a\0b", 3)));
}

// RFC 3629: the cases that its grammar leaves out.
TEST(PlainTextTest, RefusesWhatIsNotUtf8) {
  EXPECT_FALSE(IsPlainText("\x80")) << "begins in the middle";
  EXPECT_FALSE(IsPlainText("a\xC3")) << "ends in the middle";
  EXPECT_FALSE(IsPlainText("\xE2\x82")) << "ends in the middle";
  EXPECT_FALSE(IsPlainText("\xC3z")) << "no continuation";
  EXPECT_FALSE(IsPlainText("\xC1\x81")) << "longer than need be";
  EXPECT_FALSE(IsPlainText("\xE0\x81\x81")) << "longer than need be";
  EXPECT_FALSE(IsPlainText("\xF0\x81\x81\x81")) << "longer than need be";
  EXPECT_FALSE(IsPlainText("\xED\xA0\x80")) << "surrogate";
  EXPECT_FALSE(IsPlainText("\xF4\x90\x80\x80")) << "beyond U+10FFFF";
  EXPECT_FALSE(IsPlainText("\xFF"));
}

}  // namespace
}  // namespace curvereg::wire
