// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "render/colour_maps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <opencv2/imgproc.hpp>

namespace curvereg {
namespace {

using ColourTable = std::array<Rgb, 256>;

ColourTable TableOf(cv::ColormapTypes map) {
  cv::Mat ramp(1, 256, CV_8U);
  for (int i = 0; i < 256; ++i) ramp.at<uint8_t>(i) = static_cast<uint8_t>(i);
  cv::Mat bgr;
  cv::applyColorMap(ramp, bgr, map);
  ColourTable table{};
  for (int i = 0; i < 256; ++i) {
    const auto& colour = bgr.at<cv::Vec3b>(i);
    table[static_cast<std::size_t>(i)] = {colour[2], colour[1], colour[0]};
  }
  return table;
}

double Clamped(double value, double low, double high) { return std::isnan(value) ? 0.0 : std::clamp(value, low, high); }

uint8_t ToByte(double value) { return static_cast<uint8_t>(std::lround(value)); }

}  // namespace

Rgb HeightColour(double share) {
  static const ColourTable kTable = TableOf(cv::COLORMAP_VIRIDIS);
  return kTable[ToByte(255.0 * Clamped(share, 0.0, 1.0))];
}

// OpenCV has no map of two sides. Both ends are about as dark, so that the sign is in the hue alone.
Rgb SignedColour(double value) {
  const double v = Clamped(value, -1.0, 1.0);
  const std::array<double, 3> end = v < 0.0 ? std::array<double, 3>{33, 70, 160} : std::array<double, 3>{178, 24, 43};
  Rgb colour{};
  for (std::size_t c = 0; c < 3; ++c) colour[c] = ToByte(std::lerp(255.0, end[c], std::abs(v)));
  return colour;
}

Rgb GreyColour(double share) {
  const uint8_t grey = ToByte(255.0 * Clamped(share, 0.0, 1.0));
  return {grey, grey, grey};
}

Rgb BackgroundColour(double share) { return GreyColour(0.25 + 0.7 * Clamped(share, 0.0, 1.0)); }

}  // namespace curvereg
