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

TEST(OverlayPlot, KeepsTheShapeOfTheGround) {
  const Image<Rgb> picture = OverlayPlot(Ground(), Ground(), RigidTransform::Identity(), Projection::kFromAbove).pixels;
  EXPECT_NEAR(picture.cols, 801, 2);
  EXPECT_NEAR(static_cast<double>(picture.rows) / picture.cols, 0.5, 0.02);
  EXPECT_EQ(CountColours(picture), 2);  // white, and the colour of both: the scans coincide
}

TEST(OverlayPlot, AWrongPoseShowsBothColours) {
  const Image<Rgb> picture =
      OverlayPlot(Ground(), Ground(), RigidTransform(Eigen::Translation3d(5.05, 0.05, 0.0)), Projection::kFromAbove)
          .pixels;
  EXPECT_GE(CountColours(picture), 3);
}

TEST(OverlayPlot, EmptyAndUnusableScansGiveAPicture) {
  Scan unusable;
  unusable.points.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0.0f, 0.0f);
  for (const Scan& scan : {Scan{}, unusable}) {
    const Image<Rgb> picture = OverlayPlot(scan, scan, RigidTransform::Identity(), Projection::kFromTheSide).pixels;
    ASSERT_FALSE(picture.empty());
    EXPECT_EQ(picture.pixels[0], (Rgb{255, 255, 255}));
  }
  Scan point;
  point.points.emplace_back(1.0f, 2.0f, 3.0f);
  EXPECT_FALSE(OverlayPlot(point, point, RigidTransform::Identity(), Projection::kFromTheSide).pixels.empty());
}

// Where the plot's pixel of the axes' (x, y) has its centre.
std::pair<int, int> RowAndColOf(const Plot& plot, double x, double y) {
  const double right = (x - plot.x.first) / (plot.x.last - plot.x.first) * plot.pixels.cols;
  const double up = (y - plot.y.first) / (plot.y.last - plot.y.first) * plot.pixels.rows;
  return {plot.pixels.rows - 1 - static_cast<int>(up), static_cast<int>(right)};
}

TEST(OverlayPlot, AxesGiveThePlaceOfEachPoint) {
  Scan target = Ground();
  Scan source;
  source.points.emplace_back(1.0f, 2.0f, 0.0f);
  const RigidTransform T_target_source(Eigen::Translation3d(3.03, 1.03, 0.0));
  const Plot plot = OverlayPlot(source, target, T_target_source, Projection::kFromAbove);
  const auto [row, col] = RowAndColOf(plot, 4.03, 3.03);
  const Plot without = OverlayPlot(Scan{}, target, T_target_source, Projection::kFromAbove);
  int num_changed = 0;
  for (size_t i = 0; i < plot.pixels.size(); ++i)
    num_changed += plot.pixels.pixels[i] == without.pixels.pixels[i] ? 0 : 1;
  EXPECT_EQ(num_changed, 1);
  EXPECT_NE(plot.pixels(row, col), without.pixels(row, col));
  // A pixel is as wide as high.
  EXPECT_NEAR((plot.x.last - plot.x.first) / plot.pixels.cols, (plot.y.last - plot.y.first) / plot.pixels.rows, 1e-9);
}

TEST(OverlayPlot, PointersAreTheSensors) {
  RigidTransform T_target_source(Eigen::Translation3d(2.0, 3.0, 0.5));
  T_target_source.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()));
  const Plot plot = OverlayPlot(Ground(), Ground(), T_target_source, Projection::kFromAbove);
  ASSERT_EQ(plot.pointers.size(), 2U);
  EXPECT_EQ(plot.pointers[0].x, 0.0);
  EXPECT_EQ(plot.pointers[1].x, 2.0);
  EXPECT_EQ(plot.pointers[1].y, 3.0);
  EXPECT_NEAR(plot.pointers[1].direction_rad, 0.7, 1e-12);
  EXPECT_EQ(OverlayPlot(Ground(), Ground(), T_target_source, Projection::kFromTheSide).pointers[1].y, 0.5);
}

}  // namespace
}  // namespace curvereg
