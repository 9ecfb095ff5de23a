// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "render/stage_pictures.h"

#include <algorithm>
#include <cmath>

namespace curvereg {
namespace {

constexpr Rgb kInvalid = {128, 128, 128};
constexpr Rgb kMaximum = {220, 30, 40};
constexpr Rgb kMinimum = {30, 90, 240};

// The value that a `share` of the (unordered) values lies below; 0 when there are none.
float ValueAt(std::vector<float>& values, double share) {
  if (values.empty()) return 0.0F;
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

template <typename Colour>
Image<Rgb> Coloured(const Image<float>& values, int zoom, const Colour& colour) {
  Image<Rgb> picture(values.rows * zoom, values.cols * zoom);
  for (int row = 0; row < picture.rows; ++row) {
    for (int col = 0; col < picture.cols; ++col) picture(row, col) = colour(row / zoom, col / zoom);
  }
  return picture;
}

void DrawCircle(double row, double col, double radius, const Rgb& colour, Image<Rgb>& picture) {
  const int num_steps = std::max(8, static_cast<int>(std::ceil(8.0 * radius)));  // closer than a pixel
  for (int i = 0; i < num_steps; ++i) {
    const double angle = 2.0 * M_PI * i / num_steps;
    const int r = static_cast<int>(std::floor(row + radius * std::sin(angle)));
    const int c = static_cast<int>(std::floor(col + radius * std::cos(angle)));
    if (picture.Contains(r, c)) picture(r, c) = colour;
  }
}

}  // namespace

Image<Rgb> ValuePicture(const Image<float>& values, const Image<uint8_t>& valid, int zoom) {
  std::vector<float> known;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (valid.pixels[i] != 0 && std::isfinite(values.pixels[i])) known.push_back(values.pixels[i]);
  }
  const double low = ValueAt(known, 0.02);
  const double span = std::max(ValueAt(known, 0.98) - low, 1e-9);
  return Coloured(values, zoom, [&](int row, int col) {
    return valid(row, col) == 0 ? kInvalid : HeightColour((values(row, col) - low) / span);
  });
}

Image<Rgb> SignedPicture(const Image<float>& values, int zoom) {
  std::vector<float> magnitudes;
  for (const float value : values.pixels) {
    if (std::isfinite(value)) magnitudes.push_back(std::abs(value));
  }
  const double full = std::max(static_cast<double>(ValueAt(magnitudes, 0.995)), 1e-12);
  return Coloured(values, zoom, [&](int row, int col) { return SignedColour(values(row, col) / full); });
}

Image<Rgb> KeypointPicture(const Image<float>& values, const std::vector<Keypoint>& keypoints, int num_levels,
                           int zoom) {
  std::vector<float> sorted = values.pixels;
  const double low = ValueAt(sorted, 0.02);
  const double span = std::max(ValueAt(sorted, 0.98) - low, 1e-9);
  Image<Rgb> picture = Coloured(values, zoom, [&](int row, int col) {
    const double share = std::clamp((values(row, col) - low) / span, 0.0, 1.0);
    const auto grey = static_cast<uint8_t>(std::lround(60.0 + 180.0 * share));
    return Rgb{grey, grey, grey};
  });
  for (const Keypoint& keypoint : keypoints) {
    const double radius_px = 1.5 * std::exp2(num_levels - 2 - keypoint.level);
    DrawCircle((keypoint.row + 0.5) * zoom, (keypoint.col + 0.5) * zoom, radius_px * zoom,
               keypoint.response > 0.0F ? kMaximum : kMinimum, picture);
  }
  return picture;
}

Image<Rgb> FlippedRows(const Image<Rgb>& picture) {
  Image<Rgb> flipped(picture.rows, picture.cols);
  for (int row = 0; row < picture.rows; ++row) {
    std::copy_n(picture.Row(row), picture.cols, flipped.Row(picture.rows - 1 - row));
  }
  return flipped;
}

}  // namespace curvereg
