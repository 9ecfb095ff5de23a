// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "render/stage_pictures.h"

#include <algorithm>
#include <cmath>

namespace curvereg {
namespace {

constexpr Rgb kInvalid = {128, 128, 128};
constexpr Rgb kMaximum = kVermilion;
constexpr Rgb kMinimum = kBlue;

// The value that a `share` of the (unordered) values lies below; 0 when there are none.
float ValueAt(std::vector<float>& values, double share) {
  if (values.empty()) return 0.0F;
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

template <typename Colour>
Image<Rgb> Coloured(const Image<float>& values, int zoom, const Colour& colour) {
  Image<Rgb> picture(values.rows, values.cols);
  for (int row = 0; row < picture.rows; ++row) {
    for (int col = 0; col < picture.cols; ++col) picture(row, col) = colour(row, col);
  }
  return Zoomed(picture, zoom);
}

// Sets the bar from the 2nd to the 98th percentile.
ColourBar BarOf(std::vector<float> values, Rgb (*colour)(double)) {
  ColourBar bar{.label = "", .colour = colour};
  bar.low = ValueAt(values, 0.02);
  bar.high = bar.low + std::max(ValueAt(values, 0.98) - bar.low, 1e-9);
  return bar;
}

double ShareOf(const ColourBar& bar, float value) { return (value - bar.low) / (bar.high - bar.low); }

}  // namespace

Plot ValuePlot(const Image<float>& values, const Image<uint8_t>& valid, int zoom) {
  std::vector<float> known;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (valid.pixels[i] != 0 && std::isfinite(values.pixels[i])) known.push_back(values.pixels[i]);
  }
  const ColourBar bar = BarOf(std::move(known), HeightColour);
  Plot plot;
  plot.pixels = Coloured(values, zoom, [&](int row, int col) {
    return valid(row, col) == 0 ? kInvalid : HeightColour(ShareOf(bar, values(row, col)));
  });
  plot.colour_bar = bar;
  plot.legend = {{LegendEntry::Mark::kSquare, kInvalid, "no data"}};
  return plot;
}

Plot SignedPlot(const Image<float>& values, int zoom) {
  std::vector<float> magnitudes;
  for (const float value : values.pixels) {
    if (std::isfinite(value)) magnitudes.push_back(std::abs(value));
  }
  const double full = std::max(static_cast<double>(ValueAt(magnitudes, 0.995)), 1e-12);
  Plot plot;
  plot.pixels = Coloured(values, zoom, [&](int row, int col) { return SignedColour(values(row, col) / full); });
  plot.colour_bar = {
      .label = "", .low = -full, .high = full, .colour = [](double share) { return SignedColour(2.0 * share - 1.0); }};
  return plot;
}

Plot KeypointPlot(const Image<float>& values, const std::vector<Keypoint>& keypoints, int num_levels, int zoom) {
  const ColourBar bar = BarOf(values.pixels, BackgroundColour);
  Plot plot;
  plot.pixels =
      Coloured(values, zoom, [&](int row, int col) { return BackgroundColour(ShareOf(bar, values(row, col))); });
  plot.colour_bar = bar;
  plot.legend = {{LegendEntry::Mark::kCircle, kMaximum, "maximum"}, {LegendEntry::Mark::kCircle, kMinimum, "minimum"}};
  Canvas canvas(plot.pixels);
  for (const Keypoint& keypoint : keypoints) {
    const double radius_px = 1.5 * std::exp2(num_levels - 2 - keypoint.level);
    const PixelPoint centre = {(keypoint.col + 0.5) * zoom - 0.5, (keypoint.row + 0.5) * zoom - 0.5};
    canvas.Circle(centre, radius_px * zoom, keypoint.response > 0.0F ? kMaximum : kMinimum, std::min(zoom, 2));
  }
  return plot;
}

}  // namespace curvereg
