// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "render/cloud_pictures.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace curvereg {
namespace {

constexpr double kLongerSidePx = 800.0;
constexpr int kShorterSidePx = 120;
constexpr Rgb kWhite = {255, 255, 255};
constexpr Rgb kTargetColour = {70, 130, 200};
constexpr Rgb kSourceColour = {240, 140, 40};
constexpr Rgb kBothColour = {50, 40, 60};

// Part of the plane that the picture shows: position [m] of its left lower corner, and metres per pixel.
struct Window {
  Eigen::Vector2d corner = Eigen::Vector2d::Zero();
  double metres_per_px = 1.0;
  int rows = kShorterSidePx;
  int cols = kShorterSidePx;
};

// Lower and upper bound of the middle 98 %. Precondition: values are finite, at least one.
Eigen::Vector2d MiddleRange(std::vector<float> values) {
  const auto at = [&](double share) {
    const auto nth = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), nth, values.end());
    return static_cast<double>(*nth);
  };
  return {at(0.01), at(0.99)};
}

// Where an interval of this length begins that has the range in its middle.
double Centred(const Eigen::Vector2d& range, double length) { return 0.5 * (range[0] + range[1] - length); }

Window WindowOf(const Scan& target, int up_axis) {
  std::vector<float> right, up;
  for (const Eigen::Vector3f& point : target.points) {
    if (!point.allFinite()) continue;
    right.push_back(point.x());
    up.push_back(point[up_axis]);
  }
  Window window;
  if (right.empty()) return window;
  const Eigen::Vector2d right_range = MiddleRange(std::move(right));
  const Eigen::Vector2d up_range = MiddleRange(std::move(up));
  const double width = right_range[1] - right_range[0];
  const double height = up_range[1] - up_range[0];
  window.metres_per_px = std::max({width, height, 1e-3}) / kLongerSidePx;
  window.cols = std::max(static_cast<int>(width / window.metres_per_px) + 1, kShorterSidePx);
  window.rows = std::max(static_cast<int>(height / window.metres_per_px) + 1, kShorterSidePx);
  window.corner = {Centred(right_range, window.cols * window.metres_per_px),
                   Centred(up_range, window.rows * window.metres_per_px)};
  return window;
}

// Sets `bit` in each pixel that a point of the scan falls into.
void Mark(const Scan& scan, const RigidTransform& T_target_scan, int up_axis, const Window& window, uint8_t bit,
          Image<uint8_t>& marks) {
  for (const Eigen::Vector3f& point : scan.points) {
    if (!point.allFinite()) continue;
    const Eigen::Vector3d p = T_target_scan * point.cast<double>();
    const Eigen::Vector2d px = (Eigen::Vector2d(p.x(), p[up_axis]) - window.corner) / window.metres_per_px;
    if (px.minCoeff() < 0.0 || px.x() >= window.cols || px.y() >= window.rows) continue;
    marks(window.rows - 1 - static_cast<int>(px.y()), static_cast<int>(px.x())) |= bit;
  }
}

// The sensor at T_target_scan, and where its x axis points.
Pointer SensorAt(const RigidTransform& T_target_scan, int up_axis, const Rgb& colour) {
  const Eigen::Vector3d position = T_target_scan.translation();
  const Eigen::Vector3d x_axis = T_target_scan.linear().col(0);
  return {position.x(), position[up_axis], std::atan2(x_axis[up_axis], x_axis.x()), colour};
}

}  // namespace

Plot OverlayPlot(const Scan& source, const Scan& target, const RigidTransform& T_target_source, Projection projection) {
  const int up_axis = projection == Projection::kFromAbove ? 1 : 2;
  const Window window = WindowOf(target, up_axis);
  Image<uint8_t> marks(window.rows, window.cols);
  Mark(target, RigidTransform::Identity(), up_axis, window, 1, marks);
  Mark(source, T_target_source, up_axis, window, 2, marks);
  const Rgb colours[4] = {kWhite, kTargetColour, kSourceColour, kBothColour};
  Plot plot;
  plot.pixels = Image<Rgb>(window.rows, window.cols);
  for (std::size_t i = 0; i < marks.size(); ++i) plot.pixels.pixels[i] = colours[marks.pixels[i]];
  const Eigen::Vector2d end = window.corner + window.metres_per_px * Eigen::Vector2d(window.cols, window.rows);
  plot.x = {.name = "x of the target", .unit = "m", .first = window.corner.x(), .last = end.x()};
  plot.y = {.name = up_axis == 1 ? "y" : "z", .unit = "m", .first = window.corner.y(), .last = end.y()};
  plot.legend = {{LegendEntry::Mark::kSquare, kTargetColour, "target"},
                 {LegendEntry::Mark::kSquare, kSourceColour, "source"},
                 {LegendEntry::Mark::kSquare, kBothColour, "both"},
                 {LegendEntry::Mark::kArrow, kTargetColour, "sensor and its x axis"}};
  plot.pointers = {SensorAt(RigidTransform::Identity(), up_axis, kTargetColour),
                   SensorAt(T_target_source, up_axis, kSourceColour)};
  return plot;
}

}  // namespace curvereg
