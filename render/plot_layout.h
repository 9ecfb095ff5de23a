// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Where the parts of a plot's picture are, for plot.cc and its tests.
#ifndef CURVEREG_RENDER_PLOT_LAYOUT_H_
#define CURVEREG_RENDER_PLOT_LAYOUT_H_

#include <string>
#include <vector>

#include "render/plot.h"

namespace curvereg {

inline constexpr int kPlotMargin = 16;
inline constexpr int kPlotTitleHeight = 48;
inline constexpr int kTickLength = 6;
inline constexpr int kLegendMarkWidth = 26;  // with the space before the text
inline constexpr TextStyle kTitleStyle = {.height_px = 18};
inline constexpr TextStyle kLabelStyle = {.height_px = 14};
inline constexpr TextStyle kTickStyle = {.height_px = 12};

struct Ticks {
  std::vector<double> values;
  std::vector<std::string> texts;
  int widest_px = 0;  // of the texts
};

// Title above, then plot and colour bar beside each other, then x axis, then scale bar and legend in as many rows as
// they need. All [px] of the whole picture.
struct PlotLayout {
  int width = 0;
  int height = 0;
  PixelRect plot;                  // the plot's own pixels
  PixelRect colour_bar;            // its colours; empty without one
  PixelRect scale_bar;             // a filled rectangle, as wide as the length that it stands for
  std::vector<PixelPoint> legend;  // left end of each entry, at half its height
  Ticks x_ticks;
  Ticks y_ticks;
  Ticks colour_ticks;
};

PlotLayout LayoutOf(const Plot& plot);

// The colour bar as an axis, upwards.
Axis AxisOf(const ColourBar& bar);

// "name [unit]".
std::string LabelOf(const Axis& axis);

// Round values between both ends of the axis, in its direction, at most `max_count` (>= 2) of them; none when the axis
// is shorter than 1e-9 or not finite.
std::vector<double> TickValues(const Axis& axis, int max_count);

// The length that the scale bar stands for, in units of the axis: round, at most a quarter of it.
double ScaleBarLength(const Axis& x);
std::string ScaleBarText(const Axis& x);

}  // namespace curvereg

#endif  // CURVEREG_RENDER_PLOT_LAYOUT_H_
