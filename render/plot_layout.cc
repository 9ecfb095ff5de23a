// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "render/plot_layout.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace curvereg {
namespace {

constexpr int kTickSpacing = 80;    // at least, along the x axis
constexpr int kTickSpacingUp = 45;  // at least, along the y axis and the colour bar
constexpr int kXAxisHeight = 64;    // ticks, their values and the label
constexpr int kLegendRowHeight = 32;
constexpr int kLegendGap = 28;  // between entries
constexpr int kColourBarWidth = 22;
constexpr int kColourBarGap = 24;  // between plot and bar
constexpr int kScaleBarHeight = 7;

// The largest of the round numbers that is at most `value`; the smallest of them when none is.
double RoundedDown(double value, bool in_degrees) {
  if (in_degrees && value >= 5.0) {
    double largest = 5.0;
    for (const double step : {10.0, 15.0, 30.0, 45.0, 90.0}) largest = step <= value ? step : largest;
    return largest;
  }
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * decade <= value * (1.0 + 1e-9)) return factor * decade;
  }
  return decade;
}

// The smallest of the round numbers that is at least `value`.
double RoundedUp(double value, bool in_degrees) {
  if (in_degrees && value > 2.0) {
    for (const double step : {5.0, 10.0, 15.0, 30.0, 45.0, 90.0}) {
      if (step >= value) return step;
    }
  }
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * decade >= value * (1.0 - 1e-9)) return factor * decade;
  }
  return 10.0 * decade;
}

double SpanOf(const Axis& axis) { return std::max(std::abs(axis.last - axis.first), 1e-9); }

// With as many digits as multiples of `step` need.
std::string NumberText(double value, double step) {
  const int num_decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  const std::string text = absl::StrFormat("%.*f", num_decimals, value);
  return text.find_first_not_of("-0.") == std::string::npos && text.front() == '-' ? text.substr(1) : text;
}

Ticks TicksOf(const Axis& axis, int max_count) {
  Ticks ticks;
  ticks.values = TickValues(axis, max_count);
  const double step = ticks.values.size() < 2 ? 1.0 : std::abs(ticks.values[1] - ticks.values[0]);
  for (const double value : ticks.values) {
    ticks.texts.push_back(NumberText(value, step));
    ticks.widest_px = std::max(ticks.widest_px, TextWidth(ticks.texts.back(), kTickStyle));
  }
  return ticks;
}

// The scale bar and the entries of the legend, from left to right below the x axis, in as many rows as they need.
void PlaceLegend(const Plot& plot, PlotLayout& layout) {
  double row_y = layout.plot.top + layout.plot.height + kXAxisHeight + 0.5 * kLegendRowHeight;
  const double px_per_unit = layout.plot.width / SpanOf(plot.x);
  const int bar_width = std::max(1, static_cast<int>(std::lround(ScaleBarLength(plot.x) * px_per_unit)));
  layout.scale_bar = {layout.plot.left, static_cast<int>(row_y) - kScaleBarHeight / 2, bar_width, kScaleBarHeight};
  double x = layout.plot.left + bar_width + 8 + TextWidth(ScaleBarText(plot.x), kLabelStyle);
  layout.width = std::max(layout.width, static_cast<int>(x) + kPlotMargin);
  for (const LegendEntry& entry : plot.legend) {
    const int entry_width = kLegendMarkWidth + TextWidth(entry.text, kLabelStyle);
    x += kLegendGap;
    if (x + entry_width + kPlotMargin > layout.width) {
      x = layout.plot.left;
      row_y += kLegendRowHeight;
      layout.width = std::max(layout.width, layout.plot.left + entry_width + kPlotMargin);
    }
    layout.legend.push_back({x, row_y});
    x += entry_width;
  }
  layout.height = static_cast<int>(row_y + 0.5 * kLegendRowHeight) + kPlotMargin / 2;
}

}  // namespace

Axis AxisOf(const ColourBar& bar) { return {.name = bar.label, .unit = "", .first = bar.low, .last = bar.high}; }

std::string LabelOf(const Axis& axis) {
  return axis.unit.empty() ? axis.name : absl::StrCat(axis.name, " [", axis.unit, "]");
}

std::vector<double> TickValues(const Axis& axis, int max_count) {
  const double low = std::min(axis.first, axis.last);
  const double high = std::max(axis.first, axis.last);
  if (!std::isfinite(low) || !std::isfinite(high) || high - low < 1e-9) return {};
  std::vector<double> values;
  double least_step = (high - low) / max_count;
  do {
    values.clear();
    const double step = RoundedUp(least_step, axis.unit == "deg");
    const double tolerance = 1e-6 * step;
    for (double i = std::ceil((low - tolerance) / step); i * step <= high + tolerance; ++i) values.push_back(i * step);
    least_step = 1.01 * step;
  } while (values.size() > static_cast<std::size_t>(max_count));
  if (axis.first > axis.last) std::reverse(values.begin(), values.end());
  return values;
}

double ScaleBarLength(const Axis& x) { return RoundedDown(SpanOf(x) / 4.0, x.unit == "deg"); }

std::string ScaleBarText(const Axis& x) {
  const double length = ScaleBarLength(x);
  return absl::StrCat(NumberText(length, length), x.unit.empty() ? "" : " ", x.unit);
}

PlotLayout LayoutOf(const Plot& plot) {
  PlotLayout layout;
  const int width = plot.pixels.cols;
  const int height = plot.pixels.rows;
  layout.x_ticks = TicksOf(plot.x, std::max(2, width / kTickSpacing));
  layout.y_ticks = TicksOf(plot.y, std::max(3, height / kTickSpacingUp));
  const int left = kPlotMargin + 2 * kLabelStyle.height_px + layout.y_ticks.widest_px + kTickLength;
  layout.plot = {left, kPlotTitleHeight, width, height};
  int right = left + width;
  if (plot.colour_bar.has_value()) {
    layout.colour_ticks = TicksOf(AxisOf(*plot.colour_bar), std::max(3, height / kTickSpacingUp));
    layout.colour_bar = {right + kColourBarGap, kPlotTitleHeight, kColourBarWidth, height};
    right += kColourBarGap + kColourBarWidth + kTickLength + layout.colour_ticks.widest_px + 2 * kLabelStyle.height_px;
  }
  const int last_value_width = layout.x_ticks.texts.empty() ? 0 : TextWidth(layout.x_ticks.texts.back(), kTickStyle);
  right = std::max(right, left + width + last_value_width / 2);
  layout.width = std::max(right + kPlotMargin, left + TextWidth(plot.title, kTitleStyle) + kPlotMargin);
  PlaceLegend(plot, layout);
  return layout;
}

}  // namespace curvereg
