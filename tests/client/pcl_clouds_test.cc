// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/pcl_clouds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pcl/conversions.h>

#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "tests/testing/matchers.h"

namespace curvereg {
namespace {

using ::testing::ElementsAre;
using testing::HasCode;
using ::testing::HasSubstr;
using testing::IsOk;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

Scan ScanOf(std::vector<Eigen::Vector3f> points) {
  Scan scan;
  scan.points = std::move(points);
  return scan;
}

Scan ThreePoints() { return ScanOf({{1.5F, -2.25F, 3.0F}, {kNan, 0.0F, kInfinity}, {-0.0F, 1e-30F, 4e4F}}); }

// Bit by bit, so that NaN equals NaN and -0 differs from 0.
std::string BytesOf(const Scan& scan) {
  return {reinterpret_cast<const char*>(scan.points.data()), scan.points.size() * sizeof(Eigen::Vector3f)};
}

// Points of 20 bytes (ring, z, y, x, intensity), two rows of two, each row followed by 4 bytes that belong to no point.
// The coordinates are 10 * row + column, plus 0.25 for y and 0.5 for z.
pcl::PCLPointCloud2 OrganizedCloud() {
  pcl::PCLPointCloud2 cloud;
  const auto add_field = [&](const char* name, uint32_t offset, uint8_t datatype) {
    pcl::PCLPointField& field = cloud.fields.emplace_back();
    field.name = name;
    field.offset = offset;
    field.datatype = datatype;
    field.count = 1;
  };
  add_field("ring", 0, pcl::PCLPointField::UINT16);
  add_field("z", 4, pcl::PCLPointField::FLOAT32);
  add_field("y", 8, pcl::PCLPointField::FLOAT32);
  add_field("x", 12, pcl::PCLPointField::FLOAT32);
  add_field("intensity", 16, pcl::PCLPointField::FLOAT32);
  cloud.width = 2;
  cloud.height = 2;
  cloud.point_step = 20;
  cloud.row_step = 44;
  cloud.data.assign(84, 0xff);  // the last row has nothing after its points
  for (uint32_t row = 0; row < 2; ++row) {
    for (uint32_t column = 0; column < 2; ++column) {
      const float x = 10.0F * static_cast<float>(row) + static_cast<float>(column);
      const float zyx[] = {x + 0.5F, x + 0.25F, x};
      std::memcpy(cloud.data.data() + row * 44 + column * 20 + 4, zyx, sizeof zyx);
    }
  }
  return cloud;
}

TEST(PclCloudsTest, APointCloudKeepsEveryPointInItsPlace) {
  pcl::PointCloud<pcl::PointXYZI> cloud;
  cloud.emplace_back(1.0F, 2.0F, 3.0F, /*intensity=*/9.0F);
  cloud.emplace_back(kNan, kNan, kNan, 8.0F);
  cloud.emplace_back(-4.0F, 5.5F, -6.0F, 7.0F);
  const Scan scan = ScanFromPcl(cloud);
  ASSERT_EQ(scan.points.size(), 3U);
  EXPECT_EQ(scan.points[0], Eigen::Vector3f(1.0F, 2.0F, 3.0F));
  EXPECT_TRUE(scan.points[1].array().isNaN().all());
  EXPECT_EQ(scan.points[2], Eigen::Vector3f(-4.0F, 5.5F, -6.0F));
  EXPECT_FALSE(scan.gravity.has_value());
}

TEST(PclCloudsTest, AScanBecomesACloudOfOneRow) {
  const pcl::PointCloud<pcl::PointXYZI> cloud = PclCloudFromScan<pcl::PointXYZI>(ThreePoints());
  EXPECT_EQ(cloud.width, 3U);
  EXPECT_EQ(cloud.height, 1U);
  EXPECT_FALSE(cloud.is_dense);
  EXPECT_EQ(cloud[0].y, -2.25F);
  EXPECT_EQ(cloud[0].intensity, 0.0F);
  EXPECT_EQ(cloud[2].z, 4e4F);
  EXPECT_EQ(BytesOf(ScanFromPcl(cloud)), BytesOf(ThreePoints()));
}

TEST(PclCloudsTest, AScanOfFinitePointsIsDense) {
  const Scan scan = ScanOf({{1.0F, 2.0F, 3.0F}});
  EXPECT_TRUE(PclCloudFromScan(scan).is_dense);
  EXPECT_EQ(PclPointCloud2FromScan(scan).is_dense, 1);
  EXPECT_EQ(PclPointCloud2FromScan(ThreePoints()).is_dense, 0);
}

TEST(PclCloudsTest, NothingStaysNothing) {
  EXPECT_TRUE(ScanFromPcl(pcl::PointCloud<pcl::PointXYZ>()).points.empty());
  EXPECT_TRUE(PclCloudFromScan(Scan()).empty());
  const pcl::PCLPointCloud2 cloud = PclPointCloud2FromScan(Scan());
  EXPECT_TRUE(cloud.data.empty());
  const absl::StatusOr<Scan> scan = ScanFromPcl(cloud);
  ASSERT_THAT(scan, IsOk());
  EXPECT_TRUE(scan->points.empty());
}

TEST(PclCloudsTest, PointCloud2KeepsEveryBit) {
  const absl::StatusOr<Scan> scan = ScanFromPcl(PclPointCloud2FromScan(ThreePoints()));
  ASSERT_THAT(scan, IsOk());
  EXPECT_EQ(BytesOf(*scan), BytesOf(ThreePoints()));
}

TEST(PclCloudsTest, PclReadsThePointCloud2OfAScan) {
  pcl::PointCloud<pcl::PointXYZ> cloud;
  pcl::fromPCLPointCloud2(PclPointCloud2FromScan(ThreePoints()), cloud);
  EXPECT_EQ(BytesOf(ScanFromPcl(cloud)), BytesOf(ThreePoints()));
}

TEST(PclCloudsTest, ReadsThePointCloud2ThatPclWrites) {
  const auto cloud = PclCloudFromScan<pcl::PointXYZRGBNormal>(ThreePoints());
  pcl::PCLPointCloud2 blob;
  pcl::toPCLPointCloud2(cloud, blob);
  const absl::StatusOr<Scan> scan = ScanFromPcl(blob);
  ASSERT_THAT(scan, IsOk());
  EXPECT_EQ(BytesOf(*scan), BytesOf(ThreePoints()));
}

TEST(PclCloudsTest, TakesFieldsInAnyOrderAndRowsWithGaps) {
  const absl::StatusOr<Scan> scan = ScanFromPcl(OrganizedCloud());
  ASSERT_THAT(scan, IsOk());
  EXPECT_THAT(scan->points, ElementsAre(Eigen::Vector3f(0.0F, 0.25F, 0.5F), Eigen::Vector3f(1.0F, 1.25F, 1.5F),
                                        Eigen::Vector3f(10.0F, 10.25F, 10.5F), Eigen::Vector3f(11.0F, 11.25F, 11.5F)));
}

// What the message must say about OrganizedCloud() after `change`.
void ExpectRefused(const std::function<void(pcl::PCLPointCloud2&)>& change, const std::string& message) {
  pcl::PCLPointCloud2 cloud = OrganizedCloud();
  change(cloud);
  const absl::StatusOr<Scan> scan = ScanFromPcl(cloud);
  EXPECT_THAT(scan, HasCode(absl::StatusCode::kInvalidArgument));
  EXPECT_THAT(std::string(scan.status().message()), HasSubstr(message));
}

TEST(PclCloudsTest, RefusesLayoutsThatItCannotRead) {
  ExpectRefused([](auto& cloud) { cloud.is_bigendian = 1 - cloud.is_bigendian; }, "is_bigendian");
  ExpectRefused([](auto& cloud) { cloud.fields[1].name = "height"; }, "no field z");
  ExpectRefused([](auto& cloud) { cloud.fields.clear(); }, "no field x");
  ExpectRefused([](auto& cloud) { cloud.fields[2].datatype = pcl::PCLPointField::FLOAT64; },
                "field y has datatype 8, not FLOAT32");
  ExpectRefused([](auto& cloud) { cloud.fields[3].datatype = pcl::PCLPointField::INT32; }, "field x has datatype 5");
  ExpectRefused([](auto& cloud) { cloud.fields[3].count = 2; }, "field x has 2 values per point");
  ExpectRefused([](auto& cloud) { cloud.fields[1].offset = 17; }, "field z ends beyond point_step");
  ExpectRefused([](auto& cloud) { cloud.fields[1].offset = 0xffffffff; }, "field z ends beyond point_step");
}

TEST(PclCloudsTest, RefusesSizesThatContradictEachOther) {
  ExpectRefused([](auto& cloud) { cloud.data.pop_back(); }, "data has 83 bytes, less than the 84");
  ExpectRefused([](auto& cloud) { cloud.row_step = 39; }, "row_step is 39 bytes, less than the 40");
  ExpectRefused([](auto& cloud) { cloud.width = cloud.height = cloud.row_step = 0xffffffff; }, "row_step");
  ExpectRefused([](auto& cloud) { cloud.height = 0xffffffff; }, "data has 84 bytes");
}

TEST(PclCloudsTest, TakesACountOfZeroAndOneRowWithoutRowStep) {
  pcl::PCLPointCloud2 cloud = OrganizedCloud();
  cloud.fields[3].count = 0;  // some writers of PCL leave it
  cloud.height = 1;
  cloud.row_step = 0;
  const absl::StatusOr<Scan> scan = ScanFromPcl(cloud);
  ASSERT_THAT(scan, IsOk());
  EXPECT_EQ(scan->points.size(), 2U);
}

}  // namespace
}  // namespace curvereg
