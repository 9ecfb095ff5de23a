// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "render/plot.h"

#include <algorithm>
#include <cmath>

#include "render/plot_layout.h"

namespace curvereg {
namespace {

constexpr Rgb kWhite = {255, 255, 255};
constexpr Rgb kInk = {30, 30, 30};

constexpr double kPointerLength = 34.0;
constexpr TextStyle kUpwardStyle = {.height_px = kLabelStyle.height_px, .is_upward = true};

// Share of the axis below `value`.
double ShareOf(const Axis& axis, double value) { return (value - axis.first) / (axis.last - axis.first); }

void DrawXAxis(const Plot& plot, const PlotLayout& layout, Canvas& canvas) {
  const int bottom = layout.plot.top + layout.plot.height;
  for (std::size_t i = 0; i < layout.x_ticks.values.size(); ++i) {
    const double x = layout.plot.left - 0.5 + ShareOf(plot.x, layout.x_ticks.values[i]) * layout.plot.width;
    canvas.Line({x, bottom + 0.0}, {x, bottom + 0.0 + kTickLength}, kInk);
    canvas.Text({x, bottom + kTickLength + 13.0}, TextAnchor::kMiddle, layout.x_ticks.texts[i], kTickStyle, kInk);
  }
  canvas.Text({layout.plot.left + 0.5 * layout.plot.width, bottom + 46.0}, TextAnchor::kMiddle, LabelOf(plot.x),
              kLabelStyle, kInk);
}

void DrawYAxis(const Plot& plot, const PlotLayout& layout, Canvas& canvas) {
  const double left = layout.plot.left - 1.0;
  for (std::size_t i = 0; i < layout.y_ticks.values.size(); ++i) {
    const double y = layout.plot.top - 0.5 + (1.0 - ShareOf(plot.y, layout.y_ticks.values[i])) * layout.plot.height;
    canvas.Line({left - kTickLength, y}, {left, y}, kInk);
    canvas.Text({left - kTickLength - 4.0, y}, TextAnchor::kEnd, layout.y_ticks.texts[i], kTickStyle, kInk);
  }
  canvas.Text({kPlotMargin + 0.5 * kLabelStyle.height_px, layout.plot.top + 0.5 * layout.plot.height},
              TextAnchor::kMiddle, LabelOf(plot.y), kUpwardStyle, kInk);
}

void DrawColourBar(const ColourBar& bar, const PlotLayout& layout, Canvas& canvas) {
  const PixelRect& area = layout.colour_bar;
  const double right = area.left + area.width;
  for (std::size_t i = 0; i < layout.colour_ticks.values.size(); ++i) {
    const double y = area.top - 0.5 + (1.0 - ShareOf(AxisOf(bar), layout.colour_ticks.values[i])) * area.height;
    canvas.Line({right, y}, {right + kTickLength, y}, kInk);
    canvas.Text({right + kTickLength + 4.0, y}, TextAnchor::kBegin, layout.colour_ticks.texts[i], kTickStyle, kInk);
  }
  for (int row = 0; row < area.height; ++row) {
    const double share = area.height < 2 ? 1.0 : 1.0 - static_cast<double>(row) / (area.height - 1);
    canvas.Fill({area.left, area.top + row, area.width, 1}, bar.colour(share));
  }
  canvas.Outline({area.left - 1, area.top - 1, area.width + 2, area.height + 2}, kInk);
  const double label_x = right + kTickLength + layout.colour_ticks.widest_px + 1.5 * kLabelStyle.height_px;
  canvas.Text({label_x, area.top + 0.5 * area.height}, TextAnchor::kMiddle, bar.label, kUpwardStyle, kInk);
}

void DrawMark(const LegendEntry& entry, const PixelPoint& at, Canvas& canvas) {
  constexpr int kSide = 14;
  switch (entry.mark) {
    case LegendEntry::Mark::kSquare:
      canvas.Fill({static_cast<int>(at.x), static_cast<int>(at.y) - kSide / 2, kSide, kSide}, entry.colour);
      break;
    case LegendEntry::Mark::kCircle:
      canvas.Circle({at.x + 0.5 * kSide, at.y}, 0.5 * kSide, entry.colour, 2);
      break;
    case LegendEntry::Mark::kArrow:
      canvas.Arrow({at.x, at.y}, {at.x + 17.0, at.y}, entry.colour, 2);
      break;
  }
}

void DrawLegend(const Plot& plot, const PlotLayout& layout, Canvas& canvas) {
  canvas.Fill(layout.scale_bar, kInk);
  const double middle = layout.scale_bar.top + 0.5 * layout.scale_bar.height;
  canvas.Text({layout.scale_bar.left + layout.scale_bar.width + 8.0, middle}, TextAnchor::kBegin, ScaleBarText(plot.x),
              kLabelStyle, kInk);
  for (std::size_t i = 0; i < plot.legend.size(); ++i) {
    DrawMark(plot.legend[i], layout.legend[i], canvas);
    canvas.Text({layout.legend[i].x + kLegendMarkWidth, layout.legend[i].y}, TextAnchor::kBegin, plot.legend[i].text,
                kLabelStyle, kInk);
  }
}

// White below the colour, so that it shows on any ground.
void DrawPointers(const Plot& plot, Image<Rgb>& pixels) {
  Canvas canvas(pixels);
  for (const Pointer& pointer : plot.pointers) {
    const PixelPoint at = {ShareOf(plot.x, pointer.x) * pixels.cols - 0.5,
                           (1.0 - ShareOf(plot.y, pointer.y)) * pixels.rows - 0.5};
    const PixelPoint tip = {at.x + kPointerLength * std::cos(pointer.direction_rad),
                            at.y - kPointerLength * std::sin(pointer.direction_rad)};
    if (!(std::hypot(at.x, at.y) < 1e5)) continue;  // far outside, where OpenCV's integers end
    canvas.Arrow(at, tip, kWhite, 7);
    canvas.Disc(at, 7.0, kWhite);
    canvas.Arrow(at, tip, pointer.colour, 3);
    canvas.Disc(at, 5.0, pointer.colour);
  }
}

}  // namespace

Image<Rgb> FramedPlot(const Plot& plot) {
  const PlotLayout layout = LayoutOf(plot);
  Image<Rgb> picture(layout.height, layout.width, kWhite);
  Canvas canvas(picture);
  canvas.Text({layout.plot.left + 0.0, 0.5 * kPlotTitleHeight}, TextAnchor::kBegin, plot.title, kTitleStyle, kInk);
  DrawXAxis(plot, layout, canvas);
  DrawYAxis(plot, layout, canvas);
  if (plot.colour_bar.has_value()) DrawColourBar(*plot.colour_bar, layout, canvas);
  DrawLegend(plot, layout, canvas);
  // Last, over the ends of the ticks.
  Image<Rgb> pixels = plot.pixels;
  DrawPointers(plot, pixels);
  canvas.Paste(pixels, layout.plot.left, layout.plot.top);
  canvas.Outline({layout.plot.left - 1, layout.plot.top - 1, layout.plot.width + 2, layout.plot.height + 2}, kInk);
  return picture;
}

}  // namespace curvereg
