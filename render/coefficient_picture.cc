// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "render/coefficient_picture.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace curvereg {
namespace {

using Array = Image<std::complex<double>>;

constexpr double kDecades = 4.0;

// A place in one of the arrays: shares of its rows and columns, in [0, 1].
struct Place {
  std::size_t scale = 0;
  std::size_t angle = 0;
  double down = 0.0;
  double right = 0.0;
};

// Along one side of a corona, `share` in [0, 1]: which of the side's wedges, and where in it.
struct AlongSide {
  std::size_t wedge = 0;
  double within = 0.0;
};
AlongSide SplitSide(double share, std::size_t wedges_per_side) {
  const double position = std::clamp(share, 0.0, 1.0) * static_cast<double>(wedges_per_side);
  const std::size_t wedge = std::min(static_cast<std::size_t>(position), wedges_per_side - 1);
  return {wedge, position - static_cast<double>(wedge)};
}

// (x, y) in [-1, 1]^2, x to the right and y downwards. Sides clockwise: top, right, bottom, left; the last two run
// against the rows or columns of their arrays, so that these are turned back.
Place PlaceIn(const ComplexCurvelets& curvelets, double x, double y) {
  const std::size_t num_scales = curvelets.scales.size();
  const double radius = std::max({std::abs(x), std::abs(y), 1e-9});
  const int octaves_down = static_cast<int>(std::floor(-std::log2(radius)));
  const auto scale =
      static_cast<std::size_t>(std::max(0, static_cast<int>(num_scales) - 1 - std::max(0, octaves_down)));
  const std::size_t num_angles = curvelets.scales[scale].size();
  const double outer = std::exp2(static_cast<double>(scale) - static_cast<double>(num_scales - 1));
  if (num_angles < 4) return {scale, 0, 0.5 * (y / outer + 1.0), 0.5 * (x / outer + 1.0)};

  const std::size_t per_side = num_angles / 4;
  const double depth = std::clamp(2.0 * radius / outer - 1.0, 0.0, 1.0);  // 0 at the inner edge, 1 at the outer
  if (std::abs(y) >= std::abs(x)) {
    if (y < 0.0) {
      const AlongSide top = SplitSide(0.5 * (x / radius + 1.0), per_side);
      return {scale, top.wedge, 1.0 - depth, top.within};
    }
    const AlongSide bottom = SplitSide(0.5 * (1.0 - x / radius), per_side);
    return {scale, 2 * per_side + bottom.wedge, depth, 1.0 - bottom.within};
  }
  if (x > 0.0) {
    const AlongSide right = SplitSide(0.5 * (y / radius + 1.0), per_side);
    return {scale, per_side + right.wedge, right.within, depth};
  }
  const AlongSide left = SplitSide(0.5 * (1.0 - y / radius), per_side);
  return {scale, 3 * per_side + left.wedge, 1.0 - left.within, 1.0 - depth};
}

double MagnitudeAt(const Array& array, double down, double right) {
  if (array.empty()) return 0.0;
  const int row = std::clamp(static_cast<int>(down * array.rows), 0, array.rows - 1);
  const int col = std::clamp(static_cast<int>(right * array.cols), 0, array.cols - 1);
  return std::abs(array(row, col));
}

double LargestDetail(const ComplexCurvelets& curvelets) {
  double largest = 1e-300;
  for (std::size_t scale = 1; scale < curvelets.scales.size(); ++scale) {
    for (const Array& array : curvelets.scales[scale]) {
      for (const std::complex<double>& c : array.pixels) largest = std::max(largest, std::abs(c));
    }
  }
  return largest;
}

}  // namespace

Image<uint8_t> CoefficientPicture(const ComplexCurvelets& curvelets, int size_px) {
  Image<uint8_t> picture(size_px, size_px);
  if (curvelets.scales.empty()) return picture;
  const double largest = LargestDetail(curvelets);
  for (int row = 0; row < size_px; ++row) {
    for (int col = 0; col < size_px; ++col) {
      const Place place = PlaceIn(curvelets, 2.0 * (col + 0.5) / size_px - 1.0, 2.0 * (row + 0.5) / size_px - 1.0);
      const double magnitude = MagnitudeAt(curvelets.scales[place.scale][place.angle], place.down, place.right);
      const double share = 1.0 + std::log10(std::max(magnitude / largest, 1e-30)) / kDecades;
      picture(row, col) = static_cast<uint8_t>(std::lround(255.0 * std::clamp(share, 0.0, 1.0)));
    }
  }
  return picture;
}

Plot CoefficientPlot(const ComplexCurvelets& curvelets, int size_px, double step_rad) {
  const Image<uint8_t> picture = CoefficientPicture(curvelets, size_px);
  const double highest = 0.5 / (step_rad * 180.0 / std::numbers::pi);  // of half a cycle per pixel
  Plot plot;
  plot.pixels = Image<Rgb>(picture.rows, picture.cols);
  for (std::size_t i = 0; i < picture.size(); ++i) plot.pixels.pixels[i].fill(picture.pixels[i]);
  plot.title = "Curvelet coefficients of the range panorama";
  plot.x = {.name = "frequency along azimuth", .unit = "cycles/deg", .first = -highest, .last = highest};
  plot.y = {.name = "frequency along elevation", .unit = "cycles/deg", .first = -highest, .last = highest};
  plot.colour_bar = {
      .label = "log10 of magnitude / largest magnitude", .low = -kDecades, .high = 0.0, .colour = GreyColour};
  return plot;
}

}  // namespace curvereg
