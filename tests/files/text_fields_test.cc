// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/text_fields.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"

namespace curvereg {
namespace {

using ::testing::ElementsAre;

std::vector<std::string> Lines(std::string_view text) {
  std::vector<std::string> lines;
  LineReader reader(text);
  while (const auto line = reader.Next()) lines.emplace_back(*line);
  EXPECT_EQ(reader.line_number(), static_cast<int64_t>(lines.size()));
  EXPECT_EQ(reader.offset(), text.size());
  return lines;
}

TEST(LineReaderTest, TakesBothLineEndsAndAnUnfinishedLastLine) {
  EXPECT_THAT(Lines(""), ElementsAre());
  EXPECT_THAT(Lines("a\nb\r\n\nlast"), ElementsAre("a", "b", "", "last"));
  EXPECT_THAT(Lines("\n"), ElementsAre(""));
}

TEST(NextFieldTest, SplitsAtSpacesAndTabs) {
  std::string_view rest = "  one\ttwo ";
  EXPECT_EQ(NextField(rest), "one");
  EXPECT_EQ(NextField(rest), "two");
  EXPECT_EQ(NextField(rest), "");
  EXPECT_EQ(NextField(rest), "");
}

TEST(ParseNumberTest, TakesWhatFilesHold) {
  EXPECT_EQ(ParseFloat("1.5"), 1.5F);
  EXPECT_EQ(ParseFloat("+1.5"), 1.5F);
  EXPECT_EQ(ParseFloat("-2e-3"), -2e-3F);
  EXPECT_EQ(ParseFloat(".5"), 0.5F);
  EXPECT_EQ(ParseDouble("5."), 5.0);
  EXPECT_TRUE(std::isnan(ParseFloat("nan").value_or(0.0F)));
  EXPECT_TRUE(std::isnan(ParseFloat("NaN").value_or(0.0F)));
  EXPECT_TRUE(std::isnan(ParseFloat("-nan").value_or(0.0F)));
  EXPECT_EQ(ParseFloat("inf"), std::numeric_limits<float>::infinity());
  EXPECT_EQ(ParseFloat("-Inf"), -std::numeric_limits<float>::infinity());
}

TEST(ParseNumberTest, GoesToInfinityOrZeroBeyondTheRange) {
  EXPECT_EQ(ParseFloat("1e99"), std::numeric_limits<float>::infinity());
  EXPECT_EQ(ParseFloat("-1e99"), -std::numeric_limits<float>::infinity());
  EXPECT_EQ(ParseFloat("1e-99"), 0.0F);
  EXPECT_EQ(ParseDouble("-1E-999"), 0.0);
  EXPECT_EQ(ParseDouble("1e999"), std::numeric_limits<double>::infinity());
}

TEST(ParseNumberTest, RefusesTheRest) {
  for (const char* text : {"", "+", "-", "+-1", "++1", "1,5", "1.5m", "0x10", "1 ", " 1", "e5", "one", "--1"}) {
    EXPECT_FALSE(ParseFloat(text).has_value()) << text;
    EXPECT_FALSE(ParseDouble(text).has_value()) << text;
  }
}

TEST(ParseCountTest, TakesWholeNumbersFromZero) {
  EXPECT_EQ(ParseCount("0"), 0);
  EXPECT_EQ(ParseCount("9223372036854775807"), std::numeric_limits<int64_t>::max());
  for (const char* text : {"", "-1", "1.0", "9223372036854775808", "1e3", "0x1"}) {
    EXPECT_FALSE(ParseCount(text).has_value()) << text;
  }
}

TEST(AppendFloatTest, ReadsBackBitForBit) {
  for (const float value : {0.0F, -0.0F, 0.1F, 1.0F / 3.0F, 16777217.0F, 1e-45F, 3.4028235e38F, -123.456F}) {
    std::string text;
    AppendFloat(value, text);
    const float back = ParseFloat(text).value_or(-1.0F);
    EXPECT_EQ(back, value) << text;
    EXPECT_EQ(std::signbit(back), std::signbit(value)) << text;
  }
}

TEST(AppendFloatTest, NamesWhatIsNotFinite) {
  std::string text;
  AppendFloat(-std::numeric_limits<float>::quiet_NaN(), text);
  text += ' ';
  AppendFloat(-std::numeric_limits<float>::infinity(), text);
  EXPECT_EQ(text, "nan -inf");
}

TEST(QuotedTest, CutsAndCleans) {
  EXPECT_EQ(Quoted("ab\x01\xff"),
            "'ab?"
            "?'");
  EXPECT_EQ(Quoted(std::string(100, 'x')), absl::StrCat("'", std::string(40, 'x'), "...'"));
}

}  // namespace
}  // namespace curvereg
