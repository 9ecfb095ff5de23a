// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/view_features.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "tests/testing/matchers.h"
#include "tests/testing/same_bytes.h"
#include "tests/testing/scenes.h"

namespace curvereg {
namespace {

using testing::IsOk;
using Points = std::vector<Eigen::Vector3f>;

const Eigen::Matrix3d kUpright = Eigen::Matrix3d::Identity();

const Points& Ground() {
  static const Points points =
      testing::BumpyGround(testing::UprightPose(0.0, 0.0, 0.0, testing::BumpyHeight(0.0, 0.0) + 1.6)).points;
  return points;
}

// What the header promises of any view.
void ExpectConsistent(const ViewFeatures& view, const ViewOptions& options) {
  const int size = options.image.size;
  for (const Image<float>* image : {&view.image.values, &view.band_pass}) {
    ASSERT_EQ(image->rows, size);
    ASSERT_EQ(image->cols, size);
    for (const float pixel : image->pixels) ASSERT_TRUE(std::isfinite(pixel));
  }
  EXPECT_EQ(view.valid.rows, size);
  EXPECT_EQ(view.planar.size(), view.features.size());
  for (size_t i = 0; i < view.planar.size(); ++i) {
    const Keypoint& keypoint = view.features.keypoints[i];
    EXPECT_LT((view.planar[i].position - view.image.PositionOf(keypoint.row, keypoint.col)).norm(), 1e-9);
    EXPECT_EQ(view.planar[i].orientation_rad, view.features.orientations_rad[i]);
  }
}

TEST(ComputeViewFeaturesTest, ElevationViewOfUnevenGround) {
  const ViewOptions options = ElevationViewOptions();
  const auto view = ComputeViewFeatures(Ground(), kUpright, options);
  ASSERT_THAT(view, IsOk());
  ExpectConsistent(*view, options);
  EXPECT_GT(view->features.size(), 50U);
  EXPECT_EQ(view->heights_m.size(), view->features.size());
  EXPECT_TRUE(view->slices.slices.empty());
}

TEST(ComputeViewFeaturesTest, HeightsAreThoseOfTheGround) {
  const double sensor_z = testing::BumpyHeight(0.0, 0.0) + 1.6;
  const auto view = ComputeViewFeatures(Ground(), kUpright, ElevationViewOptions());
  ASSERT_THAT(view, IsOk());
  std::vector<double> errors;
  for (size_t i = 0; i < view->planar.size(); ++i) {
    const Eigen::Vector2d& at = view->planar[i].position;
    errors.push_back(std::abs(view->heights_m[i] + sensor_z - testing::BumpyHeight(at.x(), at.y())));
  }
  ASSERT_FALSE(errors.empty());
  std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.1);  // median; boulders stand above the ground
}

TEST(ComputeViewFeaturesTest, OccupancyViewOfAHall) {
  const Points points = testing::FurnishedHall(testing::UprightPose(0.5, 0.2, 0.3)).points;
  const ViewOptions options = OccupancyViewOptions();
  const auto view = ComputeViewFeatures(points, kUpright, options);
  ASSERT_THAT(view, IsOk());
  ExpectConsistent(*view, options);
  EXPECT_GT(view->features.size(), 20U);
  EXPECT_EQ(view->slices.slices.rows, options.image.size);
  EXPECT_TRUE(view->heights_m.empty());
}

TEST(ComputeViewFeaturesTest, QuarterTurnsOfTheScanTurnTheFeatures) {
  Points turned;
  for (const Eigen::Vector3f& p : Ground()) turned.emplace_back(-p.y(), p.x(), p.z());
  const auto view = ComputeViewFeatures(Ground(), kUpright, ElevationViewOptions());
  const auto view_turned = ComputeViewFeatures(turned, kUpright, ElevationViewOptions());
  ASSERT_THAT(view, IsOk());
  ASSERT_THAT(view_turned, IsOk());
  size_t num_found = 0;
  for (const PlanarFeature& feature : view->planar) {
    const Eigen::Vector2d expected(-feature.position.y(), feature.position.x());
    for (const PlanarFeature& other : view_turned->planar) {
      const double turn = other.orientation_rad - feature.orientation_rad - std::numbers::pi / 2;
      if ((other.position - expected).norm() < 0.05 && std::abs(std::remainder(turn, 2 * std::numbers::pi)) < 0.1) {
        ++num_found;
        break;
      }
    }
  }
  EXPECT_GT(static_cast<double>(num_found), 0.9 * static_cast<double>(view->planar.size()));
}

TEST(ComputeViewFeaturesTest, LevellingUndoesTheTiltOfTheSensor) {
  RigidTransform T_tilted_upright = RigidTransform::Identity();
  T_tilted_upright.linear() = RotationFromVector({0.4, -0.3, 0.0});
  Scan scan;
  scan.points = Ground();
  const Points tilted = TransformScan(scan, T_tilted_upright).points;
  const auto view = ComputeViewFeatures(Ground(), kUpright, ElevationViewOptions());
  const auto level = ComputeViewFeatures(tilted, T_tilted_upright.linear().transpose(), ElevationViewOptions());
  ASSERT_THAT(level, IsOk());
  EXPECT_TRUE(level->R_level_sensor.isApprox(T_tilted_upright.linear().transpose()));
  EXPECT_NEAR(static_cast<double>(level->planar.size()), static_cast<double>(view->planar.size()),
              0.05 * static_cast<double>(view->planar.size()));
}

TEST(ComputeViewFeaturesTest, ScansWithoutSurfaceGiveNoFeatures) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  for (const ViewOptions& options : {ElevationViewOptions(), OccupancyViewOptions()}) {
    for (const Points& points : {Points{}, Points(100, {kNan, 1.0F, 1.0F}), Points(100, {1e6F, 1.0F, 1.0F})}) {
      const auto view = ComputeViewFeatures(points, kUpright, options);
      ASSERT_THAT(view, IsOk());
      ExpectConsistent(*view, options);
      EXPECT_EQ(view->features.size(), 0U);
    }
    const auto one = ComputeViewFeatures({{1.0F, 2.0F, -1.0F}}, kUpright, options);
    ASSERT_THAT(one, IsOk());
    ExpectConsistent(*one, options);
  }
}

TEST(ComputeViewFeaturesTest, RefusesOptionsOutOfRange) {
  ViewOptions options = ElevationViewOptions();
  options.bands.num_scales = 20;
  EXPECT_THAT(ComputeViewFeatures(Ground(), kUpright, options), testing::HasCode(absl::StatusCode::kInvalidArgument));
  options = ElevationViewOptions();
  options.image.size = 0;
  EXPECT_THAT(ComputeViewFeatures(Ground(), kUpright, options), testing::HasCode(absl::StatusCode::kInvalidArgument));
}

TEST(ComputeViewFeaturesTest, SameBytesAtAnyThreadCount) {
  testing::ExpectSameBytesAtAnyThreadCount([&](testing::ByteLog& log) {
    for (const ViewOptions& options : {ElevationViewOptions(), OccupancyViewOptions()}) {
      const auto view = ComputeViewFeatures(Ground(), kUpright, options);
      log.Add(view->band_pass.pixels);
      log.Add(view->features.descriptors);
      log.Add(view->heights_m);
    }
  });
}

}  // namespace
}  // namespace curvereg
