// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "render/cloud_pictures.h"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

namespace curvereg {
namespace {

// A grid of points over 20 m by 10 m.
Scan Ground() {
  Scan scan;
  for (int i = 0; i <= 200; ++i) {
    for (int j = 0; j <= 100; ++j)
      scan.points.emplace_back(0.1f * static_cast<float>(i), 0.1f * static_cast<float>(j), 0.0f);
  }
  return scan;
}

int CountColours(const Image<Rgb>& picture) {
  std::vector<Rgb> colours = picture.pixels;
  std::sort(colours.begin(), colours.end());
  return static_cast<int>(std::unique(colours.begin(), colours.end()) - colours.begin());
}

TEST(OverlayPicture, KeepsTheShapeOfTheGround) {
  const Image<Rgb> picture = OverlayPicture(Ground(), Ground(), RigidTransform::Identity(), Projection::kFromAbove);
  EXPECT_NEAR(picture.cols, 801, 2);
  EXPECT_NEAR(static_cast<double>(picture.rows) / picture.cols, 0.5, 0.02);
  EXPECT_EQ(CountColours(picture), 2);  // white, and the colour of both: the scans coincide
}

TEST(OverlayPicture, AWrongPoseShowsBothColours) {
  const Image<Rgb> picture =
      OverlayPicture(Ground(), Ground(), RigidTransform(Eigen::Translation3d(5.05, 0.05, 0.0)), Projection::kFromAbove);
  EXPECT_GE(CountColours(picture), 3);
}

TEST(OverlayPicture, EmptyAndUnusableScansGiveAPicture) {
  Scan unusable;
  unusable.points.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0.0f, 0.0f);
  for (const Scan& scan : {Scan{}, unusable}) {
    const Image<Rgb> picture = OverlayPicture(scan, scan, RigidTransform::Identity(), Projection::kFromTheSide);
    ASSERT_FALSE(picture.empty());
    EXPECT_EQ(picture.pixels[0], (Rgb{255, 255, 255}));
  }
  Scan point;
  point.points.emplace_back(1.0f, 2.0f, 3.0f);
  EXPECT_FALSE(OverlayPicture(point, point, RigidTransform::Identity(), Projection::kFromTheSide).empty());
}

}  // namespace
}  // namespace curvereg
