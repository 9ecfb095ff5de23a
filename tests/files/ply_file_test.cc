// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/ply_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "tests/testing/corrupt_files.h"
#include "tests/testing/test_data.h"

namespace curvereg {
namespace {

using testing::BigEndianBytes;
using testing::Bytes;
using ::testing::ElementsAre;

absl::StatusOr<Scan> Parse(std::string_view bytes) { return ParsePly(bytes, {}); }

// Faces with lists come first, then an element without properties, then vertices of mixed types with a list among them.
constexpr char kProperties[] =
    "comment made by hand\nelement face 2\nproperty list uchar int vertex_indices\nproperty uchar flag\n"
    "element nothing 1000000000000\n"
    "element vertex 2\nproperty short x\nproperty list ushort double extra\nproperty double z\nproperty uchar red\n"
    "property float y\nelement edge 1\nproperty int a\nend_header\n";

template <typename Encode>
std::string Body(const Encode& encode) {
  std::string bytes;
  bytes += encode(uint8_t{3}) + encode(int32_t{0}) + encode(int32_t{1}) + encode(int32_t{2}) + encode(uint8_t{9});
  bytes += encode(uint8_t{0}) + encode(uint8_t{9});
  bytes += encode(int16_t{-7}) + encode(uint16_t{1}) + encode(0.5) + encode(3.25) + encode(uint8_t{255}) + encode(1.5F);
  bytes += encode(int16_t{300}) + encode(uint16_t{0}) + encode(-3.25) + encode(uint8_t{0}) + encode(-1.5F);
  return bytes;
}

std::string LittleEndianFile() {
  return absl::StrCat("ply\nformat binary_little_endian 1.0\n", kProperties) +
         Body([](auto value) { return Bytes(value); });
}

std::string BigEndianFile() {
  return absl::StrCat("ply\r\nformat binary_big_endian 1.0\r\n", absl::StrReplaceAll(kProperties, {{"\n", "\r\n"}})) +
         Body([](auto value) { return BigEndianBytes(value); });
}

std::string AsciiFile() {
  return absl::StrCat("ply\nformat ascii 1.0\n", kProperties,
                      "3 0 1 2 9\n0 9\n-7 1 0.5 3.25 255 1.5\n300 0 -3.25 0 -1.5");
}

TEST(PlyFileTest, ReadsAllThreeEncodings) {
  for (const std::string& bytes : {LittleEndianFile(), BigEndianFile(), AsciiFile()}) {
    // Without the edge that the header declares: what follows the vertices is not looked at.
    const absl::StatusOr<Scan> scan = testing::ParseExact(Parse, bytes);
    ASSERT_TRUE(scan.ok()) << scan.status();
    EXPECT_THAT(scan->points, ElementsAre(Eigen::Vector3f(-7, 1.5F, 3.25F), Eigen::Vector3f(300, -1.5F, -3.25F)));
  }
}

TEST(PlyFileTest, RefusesEveryTruncation) {
  testing::ExpectTruncationsRefused(Parse, LittleEndianFile(), LittleEndianFile().size());
  testing::ExpectTruncationsRefused(Parse, BigEndianFile(), BigEndianFile().size());
  // The last number, -1.5, may lose its digits unnoticed, but not its first.
  testing::ExpectTruncationsRefused(Parse, AsciiFile(), AsciiFile().size() - 2);
}

TEST(PlyFileTest, SurvivesEveryCorruptByte) {
  for (const std::string& bytes : {LittleEndianFile(), BigEndianFile(), AsciiFile()}) {
    testing::ExpectCorruptionsSurvived(Parse, bytes, 100);
  }
}

TEST(PlyFileTest, ReadsEveryNumberType) {
  const std::vector<std::pair<std::string, std::string>> types = {
      {"char", Bytes(int8_t{5})},     {"uchar", Bytes(uint8_t{5})},   {"short", Bytes(int16_t{5})},
      {"ushort", Bytes(uint16_t{5})}, {"int", Bytes(int32_t{5})},     {"uint", Bytes(uint32_t{5})},
      {"float", Bytes(5.0F)},         {"double", Bytes(5.0)},         {"int8", Bytes(int8_t{5})},
      {"uint8", Bytes(uint8_t{5})},   {"int16", Bytes(int16_t{5})},   {"uint16", Bytes(uint16_t{5})},
      {"int32", Bytes(int32_t{5})},   {"uint32", Bytes(uint32_t{5})}, {"float32", Bytes(5.0F)},
      {"float64", Bytes(5.0)}};
  for (const auto& [type, bytes] : types) {
    const std::string header = absl::StrCat("ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty ", type,
                                            " x\nproperty ", type, " y\nproperty ", type, " z\nend_header\n");
    const absl::StatusOr<Scan> scan = testing::ParseExact(Parse, header + bytes + bytes + bytes);
    ASSERT_TRUE(scan.ok()) << type << scan.status();
    EXPECT_THAT(scan->points, ElementsAre(Eigen::Vector3f(5, 5, 5))) << type;
  }
}

TEST(PlyFileTest, ReadsWhatPclWrites) {
  for (const char* name : {"pcl_ascii.ply", "pcl_binary.ply"}) {
    const absl::StatusOr<Scan> scan = Parse(testing::ReadBytes(testing::TestDataPath(absl::StrCat("clouds/", name))));
    ASSERT_TRUE(scan.ok()) << name << scan.status();
    ASSERT_EQ(scan->points.size(), 40U);
    EXPECT_EQ(scan->points[39], Eigen::Vector3f(9.75F, 1.5F, 2.5F));
    EXPECT_TRUE(std::isnan(scan->points[7].z()));
  }
}

TEST(PlyFileTest, RefusesHeadersThatLieAboutTheirSize) {
  for (const std::string& bytes : {LittleEndianFile(), BigEndianFile(), AsciiFile()}) {
    for (const char* element : {"face", "vertex"}) {
      for (const char* count : {"3", "1000000000000", "9223372036854775807"}) {
        const absl::Status status =
            Parse(absl::StrReplaceAll(bytes, {{absl::StrCat(element, " 2"), absl::StrCat(element, " ", count)}}))
                .status();
        EXPECT_TRUE(absl::IsDataLoss(status)) << element << count << status;
      }
    }
  }
}

TEST(PlyFileTest, RefusesUnusableHeaders) {
  const std::vector<std::pair<std::string, std::string>> edits = {
      {"format ascii 1.0\n", ""},
      {"format ascii 1.0", "format ebcdic 1.0"},
      {"format ascii 1.0", "format ascii 2.0"},
      {"element vertex 2", "element vortex 2"},
      {"element vertex 2", "element vertex two"},
      {"element vertex 2", "element vertex -2"},
      {"property double z", "property double w"},
      {"property double z", "property quadruple z"},
      {"property double z", "property list uchar double z"},
      {"property double z", "property double z\nproperty double z"},
      {"list uchar int", "list float int"},
      {"comment", "remark"},
      {"ply\nformat", "ply\nproperty int a\nformat"}};
  for (const auto& [from, to] : edits) {
    const absl::Status status = Parse(absl::StrReplaceAll(AsciiFile(), {{from, to}})).status();
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << to << status;
  }
}

TEST(PlyFileTest, RefusesListsOfNegativeLength) {
  const std::string bytes = absl::StrReplaceAll(AsciiFile(), {{"\n0 9\n", "\n-1 9\n"}});
  EXPECT_TRUE(absl::IsDataLoss(Parse(bytes).status()));
}

TEST(PlyFileTest, RefusesMorePointsThanTheLimit) {
  CloudReadOptions options;
  options.max_points = 1;
  EXPECT_TRUE(absl::IsResourceExhausted(ParsePly(LittleEndianFile(), options).status()));
  EXPECT_TRUE(absl::IsResourceExhausted(ParsePly(AsciiFile(), options).status()));
}

}  // namespace
}  // namespace curvereg
