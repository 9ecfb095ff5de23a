// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/text_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "tests/testing/corrupt_files.h"

namespace curvereg {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

absl::StatusOr<Scan> Parse(std::string_view bytes) { return ParseTextCloud(bytes, {}); }

void ExpectTwoPoints(std::string_view bytes) {
  const absl::StatusOr<Scan> scan = testing::ParseExact(Parse, bytes);
  ASSERT_TRUE(scan.ok()) << bytes << scan.status();
  EXPECT_THAT(scan->points, ElementsAre(Eigen::Vector3f(1, 2.5F, -3), Eigen::Vector3f(4, 5, 6))) << bytes;
}

TEST(TextFileTest, TakesEverySeparatorAndLineEnd) {
  ExpectTwoPoints("1 2.5 -3\n4 5 6\n");
  ExpectTwoPoints("1\t2.5\t-3\r\n4\t5\t6");
  ExpectTwoPoints("1,2.5,-3\n4,5,6\n");
  ExpectTwoPoints("1;2.5;-3\n4;5;6\n");
  ExpectTwoPoints("  1 ,  2.5,\t-3 \n\n4 , 5 , 6,\n");
  ExpectTwoPoints("+1 25e-1 -3.\n4 5 6\n");
}

TEST(TextFileTest, IgnoresCommentsAndFurtherColumns) {
  ExpectTwoPoints("# made by hand\n// so\n1 2.5 -3 255 red\n# between\n4 5 6 7\n");
  ExpectTwoPoints("\xEF\xBB\xBF# with a byte order mark\n1 2.5 -3\n4 5 6\n");
}

TEST(TextFileTest, FindsColumnsByName) {
  ExpectTwoPoints("x,y,z\n1,2.5,-3\n4,5,6\n");
  ExpectTwoPoints("time;\"Z\";\"Y\";\"X\"\n0;-3;2.5;1\n0;6;5;4\n");
  ExpectTwoPoints("Intensity X Y Z\n9 1 2.5 -3\n9 4 5 6\n");
  ExpectTwoPoints("east north up\n1 2.5 -3\n4 5 6\n");
}

TEST(TextFileTest, TakesAnEmptyCloudButNotProse) {
  EXPECT_TRUE(Parse("x,y,z\n").ok());
  EXPECT_TRUE(Parse("# x y z\n").ok());
  EXPECT_TRUE(absl::IsInvalidArgument(Parse("A line of prose.\n").status()));
}

TEST(TextFileTest, SkipsALeadingCount) { ExpectTwoPoints("2\n1 2.5 -3\n4 5 6\n"); }

TEST(TextFileTest, ReadsEmptyColumnsAsNoReturn) {
  const absl::StatusOr<Scan> scan = Parse("x,y,z\n1,,3\nnan,inf,-inf\n");
  ASSERT_TRUE(scan.ok()) << scan.status();
  EXPECT_TRUE(std::isnan(scan->points[0].y()));
  EXPECT_EQ(scan->points[0].z(), 3.0F);
  EXPECT_TRUE(std::isnan(scan->points[1].x()));
  EXPECT_EQ(scan->points[1].z(), -std::numeric_limits<float>::infinity());
}

TEST(TextFileTest, NamesTheLineThatIsWrong) {
  EXPECT_THAT(std::string(Parse("1 2 3\n4 5\n").status().message()), HasSubstr("line 2: has 2 columns, needs 3"));
  EXPECT_THAT(std::string(Parse("# c\n1 2 3\n4 5 six\n").status().message()),
              HasSubstr("line 3: 'six' is not a number"));
  EXPECT_THAT(std::string(Parse("x y z\na b c\n").status().message()), HasSubstr("line 2"));
  EXPECT_THAT(std::string(Parse("1,5;2,5;3,5\n").status().message()), HasSubstr("decimal commas"));
  EXPECT_THAT(std::string(Parse("h,i,x,y,z\n1,2,3,4\n").status().message()), HasSubstr("has 4 columns, needs 5"));
}

TEST(TextFileTest, SurvivesEveryTruncationAndCorruptByte) {
  const std::string text = "label;z;y;x\n1;2.5;-3;4\n4;nan;6;0\n";
  for (std::size_t length = 0; length < text.size(); ++length) {
    const absl::StatusOr<Scan> scan = testing::ParseExact(Parse, text.substr(0, length));
    if (scan.ok()) {
      EXPECT_LE(scan->points.size(), 2U);
    }
  }
  testing::ExpectCorruptionsSurvived(Parse, text, 4);
}

TEST(TextFileTest, RefusesMorePointsThanTheLimit) {
  CloudReadOptions options;
  options.max_points = 1;
  EXPECT_TRUE(absl::IsResourceExhausted(ParseTextCloud("1 2 3\n4 5 6\n", options).status()));
  EXPECT_TRUE(ParseTextCloud("1 2 3\n", options).ok());
}

TEST(LooksLikeTextTest, TellsTextFromBinary) {
  EXPECT_TRUE(LooksLikeText("1 2\t3\r\n", true));
  EXPECT_TRUE(LooksLikeText("# gr\xc3\xbc\xc3\x9f", false));
  EXPECT_FALSE(LooksLikeText("# gr\xc3\xbc\xc3\x9f", true));
  EXPECT_FALSE(LooksLikeText(std::string_view("1 2\0 3", 6), false));
}

}  // namespace
}  // namespace curvereg
