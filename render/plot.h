// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A picture with what is needed to read it: title, axes with units, scale bar, colour bar, legend.
#ifndef CURVEREG_RENDER_PLOT_H_
#define CURVEREG_RENDER_PLOT_H_

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "render/canvas.h"
#include "render/colour_maps.h"

namespace curvereg {

// Values at the two outer edges of the plot's pixels: the x axis from left to right, the y axis from below to above.
struct Axis {
  std::string name;
  std::string unit;  // with "deg", ticks are at 5, 10, 15, 30, 45 or 90
  double first = 0.0;
  double last = 1.0;
};

struct ColourBar {
  std::string label;
  double low = 0.0;
  double high = 1.0;
  std::function<Rgb(double share)> colour;  // of low at 0, of high at 1
};

struct LegendEntry {
  enum class Mark { kSquare, kCircle, kArrow };
  Mark mark = Mark::kSquare;
  Rgb colour{};
  std::string text;
};

// A place with a direction, in units of the axes; drawn as an arrow of a fixed length.
struct Pointer {
  double x = 0.0;
  double y = 0.0;
  double direction_rad = 0.0;  // from the x axis towards the y axis
  Rgb colour{};
};

struct Plot {
  Image<Rgb> pixels;
  std::string title;  // this and all other texts in ASCII
  Axis x;
  Axis y;
  std::optional<ColourBar> colour_bar;
  std::vector<LegendEntry> legend;
  std::vector<Pointer> pointers;
};

// The whole picture, black on white, laid out as plot_layout.h says. Precondition: the plot has pixels. Deterministic.
Image<Rgb> FramedPlot(const Plot& plot);

}  // namespace curvereg

#endif  // CURVEREG_RENDER_PLOT_H_
