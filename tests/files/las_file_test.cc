// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/las_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <string>

#include "tests/testing/corrupt_files.h"

namespace curvereg {
namespace {

using testing::Bytes;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A LAS file made field by field from the specification's header table.
struct LasFile {
  int minor = 2;
  int format = 0;
  std::size_t record_bytes = 20;
  uint64_t num_points = 2;
  Eigen::Vector3d scale = {0.001, 0.001, 0.01};
  Eigen::Vector3d offset = {0, 0, 0};
  std::vector<std::array<int32_t, 3>> points = {{1000, -2000, 300}, {1500, 0, -50}};

  std::string Encode() const {
    const std::size_t header_bytes = minor == 4 ? 375 : (minor == 3 ? 235 : 227);
    std::string bytes(header_bytes, '\0');
    const auto put = [&](std::size_t at, const std::string& field) { bytes.replace(at, field.size(), field); };
    put(0, "LASF");
    put(24, {char{1}, static_cast<char>(minor)});
    put(94, Bytes(static_cast<uint16_t>(header_bytes)));
    put(96, Bytes(static_cast<uint32_t>(header_bytes + 7)));  // 7 bytes of variable-length records
    put(104, Bytes(static_cast<uint8_t>(format)));
    put(105, Bytes(static_cast<uint16_t>(record_bytes)));
    if (minor < 4) put(107, Bytes(static_cast<uint32_t>(num_points)));
    if (minor == 4) put(247, Bytes(num_points));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      put(131 + 8 * axis, Bytes(scale[static_cast<Eigen::Index>(axis)]));
      put(155 + 8 * axis, Bytes(offset[static_cast<Eigen::Index>(axis)]));
    }
    bytes += "records";
    for (const auto& point : points) {
      bytes += Bytes(point[0]) + Bytes(point[1]) + Bytes(point[2]) + std::string(record_bytes - 12, 'r');
    }
    return bytes;
  }
};

absl::StatusOr<CloudWithOrigin> ParseWithOrigin(std::string_view bytes) { return ParseLas(bytes, {}); }

absl::StatusOr<Scan> Parse(std::string_view bytes) {
  absl::StatusOr<CloudWithOrigin> cloud = ParseLas(bytes, {});
  if (!cloud.ok()) return cloud.status();
  return cloud->scan;
}

TEST(LasFileTest, ReadsEveryVersionAndPointFormat) {
  constexpr std::array<std::size_t, 11> kRecordBytes = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
  for (int minor = 2; minor <= 4; ++minor) {
    for (int format = 0; format < 11; ++format) {
      LasFile file;
      file.minor = minor;
      file.format = format;
      file.record_bytes = kRecordBytes[static_cast<std::size_t>(format)] + 3;  // and three extra bytes
      const auto cloud = testing::ParseExact(ParseWithOrigin, file.Encode());
      ASSERT_TRUE(cloud.ok()) << cloud.status();
      EXPECT_THAT(cloud->scan.points, ElementsAre(Eigen::Vector3f(1, -2, 3), Eigen::Vector3f(1.5F, 0, -0.5F)));
      EXPECT_EQ(cloud->origin, Eigen::Vector3d::Zero());
    }
  }
}

TEST(LasFileTest, AddsTheOffsetWhileFloatsHoldIt) {
  LasFile file;
  file.offset = {100, 200, -10};
  const auto cloud = ParseWithOrigin(file.Encode());
  ASSERT_TRUE(cloud.ok()) << cloud.status();
  EXPECT_THAT(cloud->scan.points, ElementsAre(Eigen::Vector3f(101, 198, -7), Eigen::Vector3f(101.5F, 200, -10.5F)));
  EXPECT_EQ(cloud->origin, Eigen::Vector3d::Zero());
}

TEST(LasFileTest, SubtractsTheOffsetOfAMapFrame) {
  LasFile file;
  file.offset = {500000, 5400000, 300};
  const auto cloud = ParseWithOrigin(file.Encode());
  ASSERT_TRUE(cloud.ok()) << cloud.status();
  EXPECT_THAT(cloud->scan.points, ElementsAre(Eigen::Vector3f(1, -2, 3), Eigen::Vector3f(1.5F, 0, -0.5F)));
  EXPECT_EQ(cloud->origin, file.offset);
}

TEST(LasFileTest, SubtractsTheMiddleWhereTheOffsetIsNotWhatMakesThemLarge) {
  LasFile file;
  file.points = {{500'000'123, 2'000'000'456, 0}, {500'002'123, 2'000'004'457, 100}};
  const auto cloud = ParseWithOrigin(file.Encode());
  ASSERT_TRUE(cloud.ok()) << cloud.status();
  EXPECT_EQ(cloud->origin, Eigen::Vector3d(500001, 2000002, 1));
  for (std::size_t i = 0; i < 2; ++i) {
    const Eigen::Vector3d truth =
        Eigen::Vector3d(file.points[i][0], file.points[i][1], file.points[i][2]).cwiseProduct(file.scale);
    const Eigen::Vector3d back = cloud->scan.points[i].cast<double>() + cloud->origin;
    EXPECT_LT((back - truth).cwiseAbs().maxCoeff(), 1e-6);
  }
}

TEST(LasFileTest, HoldsAMillimetreUpToWhereItSubtracts) {
  LasFile file;
  file.points = {{16'383'999, -16'383'999, 0}};
  file.num_points = 1;
  const auto cloud = ParseWithOrigin(file.Encode());
  ASSERT_TRUE(cloud.ok()) << cloud.status();
  EXPECT_EQ(cloud->origin, Eigen::Vector3d::Zero());
  EXPECT_NEAR(cloud->scan.points[0].x(), 16383.999, 1e-3);
}

TEST(LasFileTest, RefusesLaz) {
  LasFile file;
  file.format = 0x80;
  const absl::Status status = ParseWithOrigin(file.Encode()).status();
  EXPECT_TRUE(absl::IsInvalidArgument(status));
  EXPECT_THAT(std::string(status.message()), HasSubstr("LAZ"));
}

TEST(LasFileTest, RefusesEveryTruncation) {
  for (const int minor : {2, 3, 4}) {
    LasFile file;
    file.minor = minor;
    testing::ExpectTruncationsRefused(ParseWithOrigin, file.Encode(), file.Encode().size());
  }
}

TEST(LasFileTest, SurvivesEveryCorruptByte) {
  for (const int minor : {2, 4}) {
    LasFile file;
    file.minor = minor;
    testing::ExpectCorruptionsSurvived(Parse, file.Encode(), 2);
  }
}

TEST(LasFileTest, RefusesHeadersThatLie) {
  LasFile file;
  file.minor = 4;
  for (const uint64_t num_points : {uint64_t{3}, uint64_t{1'000'000'000'000}, std::numeric_limits<uint64_t>::max()}) {
    file.num_points = num_points;
    EXPECT_TRUE(absl::IsDataLoss(ParseWithOrigin(file.Encode()).status()));
  }
  file = LasFile{};
  file.format = 1;  // whose records have 28 bytes
  EXPECT_TRUE(absl::IsDataLoss(ParseWithOrigin(file.Encode()).status()));
}

TEST(LasFileTest, RefusesScalesAndOffsetsThatAreNoNumbersOfMetres) {
  for (const double value : {0.0, -0.001, 1e300, std::numeric_limits<double>::quiet_NaN()}) {
    LasFile file;
    file.scale.y() = value;
    EXPECT_TRUE(absl::IsDataLoss(ParseWithOrigin(file.Encode()).status())) << value;
  }
  for (const double value :
       {1e300, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    LasFile file;
    file.offset.z() = value;
    EXPECT_TRUE(absl::IsDataLoss(ParseWithOrigin(file.Encode()).status())) << value;
  }
}

TEST(LasFileTest, RefusesOtherVersionsAndFormats) {
  LasFile file;
  file.minor = 5;
  EXPECT_TRUE(absl::IsInvalidArgument(ParseWithOrigin(file.Encode()).status()));
  file = LasFile{};
  file.format = 11;
  file.record_bytes = 100;
  EXPECT_TRUE(absl::IsInvalidArgument(ParseWithOrigin(file.Encode()).status()));
}

TEST(LasFileTest, RefusesMorePointsThanTheLimit) {
  CloudReadOptions options;
  options.max_points = 1;
  EXPECT_TRUE(absl::IsResourceExhausted(ParseLas(LasFile{}.Encode(), options).status()));
}

TEST(LasFileTest, TakesAnEmptyCloud) {
  LasFile file;
  file.num_points = 0;
  file.points.clear();
  const auto cloud = ParseWithOrigin(file.Encode());
  ASSERT_TRUE(cloud.ok()) << cloud.status();
  EXPECT_TRUE(cloud->scan.points.empty());
}

}  // namespace
}  // namespace curvereg
