// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/paper_features.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/parallel.h"
#include "core/base/rigid_transform.h"
#include "tests/testing/hummocks.h"

namespace curvereg {
namespace {

// The image goes around: turning the scan by whole pixels moves the features and changes few (the smooth filling of the
// sky is not quite the same), at the seam no more than elsewhere.
TEST(PaperFeaturesTest, FeaturesFollowAYawOfWholePixels) {
  const Scan& scan = testing::SmallMotion().target;
  const RigidTransform turn =
      TransformFromVector((Vector6d() << 0.0, 0.0, 0.5 * std::numbers::pi, 0.0, 0.0, 0.0).finished());
  const auto before = ComputePaperFeatures(scan, {}, Stop{});
  const auto after = ComputePaperFeatures(TransformScan(scan, turn), {}, Stop{});
  ASSERT_TRUE(before.ok() && after.ok());
  int num_at_seam = 0, num_found = 0, num_found_at_seam = 0;
  for (const Eigen::Vector3d& point : before->points) {
    const Eigen::Vector3d turned = turn * point;
    const bool is_found = std::ranges::any_of(
        after->points, [&](const Eigen::Vector3d& other) { return (turned - other).norm() < 1e-3; });
    const bool is_at_seam = std::abs(std::atan2(turned.y(), turned.x())) > std::numbers::pi - 0.1;
    num_found += is_found ? 1 : 0;
    num_at_seam += is_at_seam ? 1 : 0;
    num_found_at_seam += is_found && is_at_seam ? 1 : 0;
  }
  EXPECT_GE(num_found, static_cast<int>(0.85 * static_cast<double>(before->points.size())));
  EXPECT_GE(num_at_seam, 15);
  EXPECT_GE(num_found_at_seam, static_cast<int>(0.85 * num_at_seam));
}

TEST(PaperFeaturesTest, FeaturesLieOnReturnsThatAreNotNear) {
  const Scan& scan = testing::SmallMotion().target;
  PaperFeatureOptions options;
  options.min_range_m = 9.0;
  const PaperFeatures features = *ComputePaperFeatures(scan, options, Stop{});
  ASSERT_GT(features.points.size(), 20U);
  ASSERT_EQ(features.points.size(), features.features.size());
  for (const Eigen::Vector3d& point : features.points) EXPECT_GE(point.norm(), 9.0);
  options.keypoints.min_response = 0.05;
  EXPECT_LT(ComputePaperFeatures(scan, options, Stop{})->points.size(), features.points.size());
}

TEST(PaperFeaturesTest, DescribesEachKeyPointOnceAndUpright) {
  const PaperFeatures features = *ComputePaperFeatures(testing::SmallMotion().target, {}, Stop{});
  ASSERT_GT(features.features.size(), 50U);
  EXPECT_EQ(features.features.descriptors.size(), features.features.size() * kDescriptorSize);
  for (size_t i = 0; i < features.features.size(); ++i) {
    const Keypoint& keypoint = features.features.keypoints[i];
    EXPECT_EQ(features.features.orientations_rad[i], 0.0F);
    EXPECT_GE(std::abs(keypoint.response), 0.005F);
    EXPECT_GE(keypoint.col, -0.5F);
    EXPECT_LT(keypoint.col, 719.5F);
    // The pixel of the key point is the direction of its return.
    const double azimuth = std::atan2(features.points[i].y(), features.points[i].x());
    const double expected = std::numbers::pi - (std::floor(keypoint.col + 0.5F) + 0.5) * std::numbers::pi / 360.0;
    EXPECT_NEAR(azimuth, expected, 0.5 * std::numbers::pi / 360.0 + 1e-6);
  }
}

TEST(PaperFeaturesTest, SameBytesAtAnyThreadCount) {
  const Scan& scan = testing::SmallMotion().source;
  const PaperFeatures serial = *ComputePaperFeatures(scan, {}, Stop{});
  for (const int num_threads : {1, 2, 4}) {
    PaperFeatures features;
    WithThreadLimit(num_threads, [&] { features = *ComputePaperFeatures(scan, {}, Stop{}); });
    EXPECT_EQ(features.points, serial.points) << num_threads;
    EXPECT_EQ(features.features.descriptors, serial.features.descriptors) << num_threads;
  }
}

TEST(PaperFeaturesTest, NothingSeenNothingDescribed) {
  EXPECT_EQ(ComputePaperFeatures(Scan{}, {}, Stop{})->features.size(), 0U);
  Scan missing;
  missing.points.assign(500, Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  EXPECT_EQ(ComputePaperFeatures(missing, {}, Stop{})->features.size(), 0U);
}

TEST(PaperFeaturesTest, ObeysTheStopAndRefusesBadOptions) {
  const Scan& scan = testing::SmallMotion().target;
  std::stop_source source;
  source.request_stop();
  EXPECT_EQ(ComputePaperFeatures(scan, {}, Stop{source.get_token(), {}}).status().code(), absl::StatusCode::kCancelled);
  EXPECT_EQ(ComputePaperFeatures(scan, {}, Stop{{}, std::chrono::steady_clock::now()}).status().code(),
            absl::StatusCode::kDeadlineExceeded);
  PaperFeatureOptions options;
  options.num_scales = 1;
  EXPECT_EQ(ComputePaperFeatures(scan, options, Stop{}).status().code(), absl::StatusCode::kInvalidArgument);
  options = {};
  options.blur_sigma_px = -1.0;
  EXPECT_EQ(Validate(options).code(), absl::StatusCode::kInvalidArgument);
  EXPECT_TRUE(Validate(PaperFeatureOptions{}).ok());
}

}  // namespace
}  // namespace curvereg
