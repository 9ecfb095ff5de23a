// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/baselines/pcl_common.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/baselines/bumpy_ground.h"

namespace curvereg::pcl_common {
namespace {

using curvereg::testing::BumpyScan;
using curvereg::testing::SensorPose;

// A square of side 4 m, points 0.25 m apart, 2 m below the sensor.
Scan FlatSquare() {
  Scan scan;
  for (int i = -8; i <= 8; ++i) {
    for (int j = -8; j <= 8; ++j) scan.points.emplace_back(0.25F * float(i), 0.25F * float(j), -2.0F);
  }
  return scan;
}

TEST(PclCommonTest, NormalsPointTowardsTheSensor) {
  const Surface surface = PrepareSurface(FlatSquare(), {});
  ASSERT_EQ(surface.cloud->size(), 17U * 17U);
  ASSERT_EQ(surface.normals->size(), surface.cloud->size());
  for (const pcl::Normal& normal : *surface.normals) EXPECT_NEAR(normal.normal_z, 1.0F, 1e-5F);
}

TEST(PclCommonTest, LeavesOutPointsWithoutANormal) {
  Scan scan = FlatSquare();
  scan.points.emplace_back(50.0F, 0.0F, 0.0F);
  EXPECT_EQ(PrepareSurface(scan, {}).cloud->size(), 17U * 17U);
}

TEST(PclCommonTest, ThinsToOnePointPerVoxel) {
  BaselineOptions options;
  options.voxel_size_m = 1.0;
  options.normal_radius_m = 2.0;  // so that every voxel has neighbours
  const Surface surface = PrepareSurface(FlatSquare(), options);
  EXPECT_EQ(surface.cloud->size(), 25U);  // [-2, 2] touches five voxels of 1 m
}

TEST(PclCommonTest, RefusesMoreVoxelsThanPclCanNumber) {
  BaselineOptions options;
  Scan scan = FlatSquare();
  scan.points.emplace_back(5000.0F, 5000.0F, 100.0F);
  options.voxel_size_m = 0.1;
  EXPECT_EQ(ValidateInputs(scan, scan, options).code(), absl::StatusCode::kInvalidArgument);
  options.voxel_size_m = 10.0;
  EXPECT_TRUE(ValidateInputs(scan, scan, options).ok());
}

TEST(PclCommonTest, DescriptorsOfAPlaneAreAllAlikeInside) {
  const Surface surface = PrepareSurface(FlatSquare(), {});
  const Features::Ptr features = DescribePoints(surface.cloud, surface, {});
  ASSERT_EQ(features->size(), surface.cloud->size());
  const auto& middle = (*features)[features->size() / 2].histogram;
  float sum = 0.0F;
  for (const float value : middle) sum += value;
  EXPECT_NEAR(sum, 300.0F, 0.1F);        // three histograms of 100 %
  EXPECT_NEAR(middle[5], 100.0F, 0.1F);  // no normal turns: each of the three has all its weight in its middle bin
  EXPECT_NEAR(middle[16], 100.0F, 0.1F);
  EXPECT_NEAR(middle[27], 100.0F, 0.1F);
}

TEST(PclCommonTest, IcpAlignsACloudToItself) {
  const RigidTransform T_target_source = SensorPose(0.3, -0.2, 0.03, 0.1);
  const Scan target_scan = BumpyScan(SensorPose(0.0, 0.0, 0.0), 3);
  const Surface target = PrepareSurface(target_scan, {});
  const Surface source = PrepareSurface(TransformScan(target_scan, T_target_source.inverse()), {});
  BaselineResult result;
  result.T_target_source = RigidTransform::Identity();
  RefineByIcp(source, target, {}, result);
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.num_inliers, static_cast<int>(source.cloud->size()));
  const TransformDifference error = Difference(*result.T_target_source, T_target_source);
  EXPECT_LT(error.translation_m, 0.02);
  EXPECT_LT(error.rotation_rad, 0.002);
}

TEST(PclCommonTest, IcpWithoutPartnersKeepsThePose) {
  const Scan scan = BumpyScan(SensorPose(0.0, 0.0, 0.0), 3, 1000);
  const Surface surface = PrepareSurface(scan, {});
  BaselineResult result;
  result.T_target_source = RigidTransform::Identity();
  result.T_target_source->translation() = Eigen::Vector3d(1000.0, 0.0, 0.0);
  RefineByIcp(surface, surface, {}, result);
  EXPECT_FALSE(result.converged);
  EXPECT_EQ(result.num_iterations, 0);
  EXPECT_EQ(result.T_target_source->translation().x(), 1000.0);
}

TEST(PclCommonTest, AStoppedTreeFindsNothing) {
  std::stop_source cancel;
  Stop stop;
  stop.cancellation = cancel.get_token();
  auto cloud = pcl::make_shared<Cloud>();
  cloud->push_back({1.0F, 0.0F, 0.0F});
  cloud->push_back({0.0F, 1.0F, 0.0F});
  InterruptibleKdTree tree(stop);
  tree.setInputCloud(cloud, nullptr);
  pcl::Indices found;
  std::vector<float> squared_distances;
  EXPECT_EQ(tree.radiusSearch(pcl::PointXYZ(0.0F, 0.0F, 0.0F), 2.0, found, squared_distances, 0), 2);
  EXPECT_EQ(tree.nearestKSearch(pcl::PointXYZ(0.9F, 0.0F, 0.0F), 1, found, squared_distances), 1);
  EXPECT_EQ(found[0], 0);
  cancel.request_stop();
  EXPECT_EQ(tree.radiusSearch(pcl::PointXYZ(0.0F, 0.0F, 0.0F), 2.0, found, squared_distances, 0), 0);
  EXPECT_EQ(tree.nearestKSearch(pcl::PointXYZ(0.9F, 0.0F, 0.0F), 1, found, squared_distances), 0);
  EXPECT_GT(squared_distances[0], 1e30F);
}

}  // namespace
}  // namespace curvereg::pcl_common
