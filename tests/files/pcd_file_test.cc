// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/pcd_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "tests/testing/corrupt_files.h"
#include "tests/testing/test_data.h"

namespace curvereg {
namespace {

using testing::Bytes;
using ::testing::HasSubstr;

absl::StatusOr<Scan> Parse(std::string_view bytes) { return ParsePcd(bytes, {}); }

constexpr char kHeader[] =
    "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
    "WIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ";

std::string Floats(std::initializer_list<float> values) {
  std::string bytes;
  for (const float value : values) bytes += Bytes(value);
  return bytes;
}

// The cloud that the files in tests/data/clouds hold, written by PCL 1.13.
void ExpectPclCloud(const Scan& scan) {
  ASSERT_EQ(scan.points.size(), 40U);
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector3f& point = scan.points[static_cast<std::size_t>(i)];
    EXPECT_EQ(point.x(), 0.25F * static_cast<float>(i));
    EXPECT_EQ(point.y(), -1.5F + static_cast<float>(i % 4));
    if (i == 7) {
      EXPECT_TRUE(std::isnan(point.z()));
    } else {
      EXPECT_EQ(point.z(), 100.0F / static_cast<float>(i + 1));
    }
  }
}

TEST(PcdFileTest, ReadsWhatPclWrites) {
  for (const char* name : {"pcl_ascii.pcd", "pcl_binary.pcd", "pcl_compressed.pcd"}) {
    SCOPED_TRACE(name);
    const absl::StatusOr<Scan> scan = Parse(testing::ReadBytes(testing::TestDataPath(absl::StrCat("clouds/", name))));
    ASSERT_TRUE(scan.ok()) << scan.status();
    ExpectPclCloud(*scan);
  }
}

TEST(PcdFileTest, RefusesEveryTruncation) {
  for (const char* name : {"pcl_binary.pcd", "pcl_compressed.pcd", "pcl_ascii.pcd"}) {
    SCOPED_TRACE(name);
    const std::string bytes = testing::ReadBytes(testing::TestDataPath(absl::StrCat("clouds/", name)));
    // In an ascii file the last number may lose digits unnoticed; here it has the one digit of the intensity, 7.
    const std::size_t size = bytes.size() - (bytes.back() == '\n' ? 1 : 0);
    testing::ExpectTruncationsRefused(Parse, bytes, size);
  }
}

TEST(PcdFileTest, SurvivesEveryCorruptByte) {
  for (const char* name : {"pcl_binary.pcd", "pcl_compressed.pcd", "pcl_ascii.pcd"}) {
    SCOPED_TRACE(name);
    testing::ExpectCorruptionsSurvived(Parse, testing::ReadBytes(testing::TestDataPath(absl::StrCat("clouds/", name))),
                                       4000);
  }
}

TEST(PcdFileTest, SkipsOtherFieldsInAnyPlace) {
  // z as double and first, then three bytes, x, two 16-bit labels, y.
  std::string bytes =
      "VERSION .7\nFIELDS z rgb x label y\nSIZE 8 1 4 2 8\nTYPE F U F I F\nCOUNT 1 3 1 2 1\nWIDTH 2\nHEIGHT 1\n"
      "POINTS 2\nDATA binary\n";
  for (const double i : {1.0, 2.0}) {
    bytes += Bytes(30.0 + i) + "rgb" + Bytes(static_cast<float>(10.0 + i)) + "abcd" + Bytes(20.0 + i);
  }
  const absl::StatusOr<Scan> scan = testing::ParseExact(Parse, bytes);
  ASSERT_TRUE(scan.ok()) << scan.status();
  EXPECT_THAT(scan->points, ::testing::ElementsAre(Eigen::Vector3f(11, 21, 31), Eigen::Vector3f(12, 22, 32)));
}

TEST(PcdFileTest, ReadsAsciiWithCountsAndOtherFields) {
  const absl::StatusOr<Scan> scan = Parse(
      "VERSION 0.7\r\nFIELDS hist x y z\r\nSIZE 4 4 4 4\r\nTYPE U F F F\r\nCOUNT 2 1 1 1\r\nWIDTH 2\r\nHEIGHT 1\r\n"
      "DATA ascii\r\n7 8 1 2 3\r\n\r\n9 9 nan -inf +4.5e1\r\n");
  ASSERT_TRUE(scan.ok()) << scan.status();
  ASSERT_EQ(scan->points.size(), 2U);
  EXPECT_EQ(scan->points[0], Eigen::Vector3f(1, 2, 3));
  EXPECT_TRUE(std::isnan(scan->points[1].x()));
  EXPECT_EQ(scan->points[1].y(), -std::numeric_limits<float>::infinity());
  EXPECT_EQ(scan->points[1].z(), 45.0F);
}

TEST(PcdFileTest, KeepsBitsOfBinaryFloats) {
  const std::string body =
      Floats({-0.0F, 1e-42F, std::numeric_limits<float>::infinity(), 1, 2, std::numeric_limits<float>::quiet_NaN()});
  const absl::StatusOr<Scan> scan = testing::ParseExact(Parse, absl::StrCat(kHeader, "binary\n") + body);
  ASSERT_TRUE(scan.ok()) << scan.status();
  EXPECT_EQ(std::memcmp(scan->points.data(), body.data(), body.size()), 0);
}

TEST(PcdFileTest, TakesAnEmptyCloud) {
  std::string bytes = absl::StrReplaceAll(kHeader, {{"WIDTH 2", "WIDTH 0"}, {"POINTS 2", "POINTS 0"}});
  for (const char* data : {"ascii\n", "binary\n", "binary_compressed\n"}) {
    const absl::StatusOr<Scan> scan = Parse(bytes + data);
    ASSERT_TRUE(scan.ok()) << scan.status();
    EXPECT_TRUE(scan->points.empty());
  }
}

TEST(PcdFileTest, RefusesHeadersThatLieAboutTheirSize) {
  for (const char* data :
       {"ascii\n1 2 3\n4 5 6\n", "binary\nabcdefghijklmnopqrstuvwx", "binary_compressed\nabcdefgh"}) {
    for (const char* count : {"3", "1000000000000", "9223372036854775807"}) {
      const std::string bytes = absl::StrReplaceAll(
          absl::StrCat(kHeader, data),
          {{"WIDTH 2", absl::StrCat("WIDTH ", count)}, {"POINTS 2", absl::StrCat("POINTS ", count)}});
      const absl::Status status = testing::ParseExact(Parse, bytes).status();
      EXPECT_TRUE(absl::IsDataLoss(status)) << status;
    }
  }
}

TEST(PcdFileTest, RefusesMorePointsThanDeclared) {
  const absl::Status binary = Parse(absl::StrCat(kHeader, "binary\n") + Floats({1, 2, 3, 4, 5, 6, 7, 8, 9})).status();
  EXPECT_TRUE(absl::IsDataLoss(binary)) << binary;
  const absl::Status ascii = Parse(absl::StrCat(kHeader, "ascii\n1 2 3\n4 5 6\n7 8 9\n")).status();
  EXPECT_TRUE(absl::IsDataLoss(ascii)) << ascii;
  EXPECT_TRUE(Parse(absl::StrCat(kHeader, "binary\n") + Floats({1, 2, 3, 4, 5, 6, 0, 0, 0})).ok()) << "padding";
}

TEST(PcdFileTest, RefusesContradictingAndUnusableHeaders) {
  const std::string good = absl::StrCat(kHeader, "ascii\n1 2 3\n4 5 6\n");
  ASSERT_TRUE(Parse(good).ok());
  const std::vector<std::pair<std::string, std::string>> edits = {
      {"FIELDS x y z", "FIELDS x y w"}, {"FIELDS x y z", "FIELDS"},
      {"SIZE 4 4 4", "SIZE 4 4"},       {"SIZE 4 4 4", "SIZE 4 4 3"},
      {"SIZE 4 4 4", "SIZE 4 4 2"},     {"TYPE F F F", "TYPE F F Q"},
      {"TYPE F F F", "TYPE F F I"},     {"COUNT 1 1 1", "COUNT 1 1 0"},
      {"COUNT 1 1 1", "COUNT 1 1 2"},   {"COUNT 1 1 1", "COUNT 1 1 1 1"},
      {"WIDTH 2", "WIDTH -2"},          {"WIDTH 2", "WIDTH two"},
      {"WIDTH 2", "WIDTH 3"},           {"HEIGHT 1", "HEIGHT 2"},
      {"DATA ascii", "DATA zip"},       {"WIDTH 2", "WIDTH 4611686018427387904\nHEIGHT 4"},
      {"VERSION 0.7", "VERSIO 0.7"},    {"POINTS 2\n", "POINTS 9223372036854775808\n"}};
  for (const auto& [from, to] : edits) {
    EXPECT_FALSE(Parse(absl::StrReplaceAll(good, {{from, to}})).ok()) << to;
  }
}

TEST(PcdFileTest, NamesTheLineThatIsNotNumbers) {
  const absl::Status status = Parse(absl::StrCat(kHeader, "ascii\n1 2 3\n4 five 6\n")).status();
  EXPECT_TRUE(absl::IsDataLoss(status));
  EXPECT_THAT(std::string(status.message()), HasSubstr("line 13 'five' is not a number"));
}

TEST(PcdFileTest, RefusesMorePointsThanTheLimit) {
  CloudReadOptions options;
  options.max_points = 1;
  for (const std::string& data : {std::string("ascii\n1 2 3\n4 5 6\n"), "binary\n" + Floats({1, 2, 3, 4, 5, 6})}) {
    EXPECT_TRUE(absl::IsResourceExhausted(ParsePcd(kHeader + data, options).status()));
  }
}

}  // namespace
}  // namespace curvereg
