// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "render/plot.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render/plot_layout.h"

namespace curvereg {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;

constexpr Rgb kWhite = {255, 255, 255};
constexpr Rgb kGreen = {10, 200, 30};

// 600 px for 60 m, 300 px for 30 m.
Plot Map() {
  Plot plot;
  plot.pixels = Image<Rgb>(300, 600, kGreen);
  plot.title = "A map";
  plot.x = {.name = "x", .unit = "m", .first = -30.0, .last = 30.0};
  plot.y = {.name = "y", .unit = "m", .first = -15.0, .last = 15.0};
  plot.colour_bar = {.label = "height [m]", .low = -1.0, .high = 2.0, .colour = HeightColour};
  plot.legend = {{LegendEntry::Mark::kSquare, {200, 0, 0}, "stones"},
                 {LegendEntry::Mark::kCircle, {0, 0, 200}, "craters"}};
  return plot;
}

bool HasInk(const Image<Rgb>& picture, const PixelRect& area) {
  for (int row = area.top; row < area.top + area.height; ++row) {
    for (int col = area.left; col < area.left + area.width; ++col) {
      if (picture(row, col) != kWhite) return true;
    }
  }
  return false;
}

int CountPixels(const Image<Rgb>& picture, const Rgb& colour) {
  return static_cast<int>(std::count(picture.pixels.begin(), picture.pixels.end(), colour));
}

TEST(FramedPlot, HoldsThePlotsPixels) {
  Plot plot = Map();
  for (size_t i = 0; i < plot.pixels.size(); ++i) plot.pixels.pixels[i] = {static_cast<uint8_t>(i), 9, 9};
  const Image<Rgb> picture = FramedPlot(plot);
  const PixelRect area = LayoutOf(plot).plot;
  ASSERT_EQ(area.width, 600);
  ASSERT_EQ(area.height, 300);
  for (int row = 0; row < 300; ++row) {
    for (int col = 0; col < 600; ++col) {
      ASSERT_EQ(picture(area.top + row, area.left + col), plot.pixels(row, col)) << row << " " << col;
    }
  }
}

TEST(FramedPlot, TheScaleBarIsAsLongAsItSays) {
  const Plot plot = Map();
  EXPECT_EQ(ScaleBarLength(plot.x), 10.0);
  EXPECT_EQ(ScaleBarText(plot.x), "10 m");
  const PixelRect bar = LayoutOf(plot).scale_bar;
  EXPECT_EQ(bar.width, 100);  // 10 px a metre
  const Image<Rgb> picture = FramedPlot(plot);
  const int row = bar.top + bar.height / 2;
  for (int col = bar.left; col < bar.left + bar.width; ++col) EXPECT_LT(picture(row, col)[0], 50) << col;
  EXPECT_EQ(picture(row, bar.left - 1), kWhite);
  EXPECT_EQ(picture(row, bar.left + bar.width), kWhite);
  EXPECT_TRUE(HasInk(picture, {bar.left + bar.width + 4, bar.top - 6, 40, 20}));  // its text
}

TEST(FramedPlot, TheColourBarEndsInTheColoursOfBothEnds) {
  const Plot plot = Map();
  const PixelRect bar = LayoutOf(plot).colour_bar;
  const Image<Rgb> picture = FramedPlot(plot);
  const int col = bar.left + bar.width / 2;
  EXPECT_EQ(picture(bar.top, col), HeightColour(1.0));
  EXPECT_EQ(picture(bar.top + bar.height - 1, col), HeightColour(0.0));
  EXPECT_EQ(picture(bar.top + 150, col), HeightColour(1.0 - 150.0 / 299.0));
  EXPECT_THAT(LayoutOf(plot).colour_ticks.texts, ElementsAre("-1", "0", "1", "2"));
}

TEST(FramedPlot, TitleAxesAndLegendAreThere) {
  const Plot plot = Map();
  const PlotLayout layout = LayoutOf(plot);
  const Image<Rgb> picture = FramedPlot(plot);
  EXPECT_TRUE(HasInk(picture, {layout.plot.left, 10, 60, 30}));
  const int below = layout.plot.top + layout.plot.height + 1;
  EXPECT_TRUE(HasInk(picture, {layout.plot.left, below + 8, layout.plot.width, 20}));   // values at the ticks
  EXPECT_TRUE(HasInk(picture, {layout.plot.left, below + 35, layout.plot.width, 20}));  // "x [m]"
  EXPECT_TRUE(HasInk(picture, {8, layout.plot.top, 24, layout.plot.height}));           // "y [m]"
  EXPECT_EQ(LabelOf(plot.y), "y [m]");
  EXPECT_GE(CountPixels(picture, {200, 0, 0}), 100);
  EXPECT_GE(CountPixels(picture, {0, 0, 200}), 10);
  Plot bare = plot;
  bare.title = "";
  bare.legend.clear();
  EXPECT_FALSE(HasInk(FramedPlot(bare), {0, 0, layout.plot.width, layout.plot.top - 1}));
  EXPECT_EQ(CountPixels(FramedPlot(bare), {200, 0, 0}), 0);
}

// The first tick's mark, just left of and below the plot.
TEST(FramedPlot, TicksAreWhereTheirValuesAre) {
  const Plot plot = Map();
  const PlotLayout layout = LayoutOf(plot);
  EXPECT_THAT(layout.x_ticks.texts, ElementsAre("-30", "-20", "-10", "0", "10", "20", "30"));
  EXPECT_THAT(layout.y_ticks.texts, ElementsAre("-10", "0", "10"));
  const Image<Rgb> picture = FramedPlot(plot);
  const int below = layout.plot.top + layout.plot.height + 3;
  EXPECT_LT(picture(below, layout.plot.left + 100)[0], 200);  // -20 m, 10 px a metre
  EXPECT_EQ(picture(below, layout.plot.left + 50), kWhite);
  const int beside = layout.plot.left - 4;
  EXPECT_LT(picture(layout.plot.top + 50, beside)[0], 200);  // 10 m
  EXPECT_EQ(picture(layout.plot.top + 75, beside), kWhite);
}

TEST(FramedPlot, PointersAreDrawnInsideOfThePlotOnly) {
  const Rgb colour = {200, 0, 100};
  Plot plot = Map();
  plot.pointers = {{10.0, 5.0, 0.5 * M_PI, colour}};
  const PixelRect area = LayoutOf(plot).plot;
  const Image<Rgb> picture = FramedPlot(plot);
  EXPECT_EQ(picture(area.top + 100, area.left + 400), colour);
  EXPECT_EQ(picture(area.top + 75, area.left + 400), colour);  // upwards
  EXPECT_EQ(picture(area.top + 125, area.left + 400), kGreen);
  const int num_around = CountPixels(FramedPlot(Map()), kWhite);
  for (const double x : {29.9, 1e3, 1e12, std::nan("")}) {
    plot.pointers = {{x, 0.0, 0.0, colour}};
    Image<Rgb> framed = FramedPlot(plot);
    Canvas(framed).Fill(area, kGreen);
    EXPECT_EQ(CountPixels(framed, kWhite), num_around) << x;
  }
}

TEST(FramedPlot, LongLegendsGetMoreRowsAndNothingIsCutOff) {
  Plot plot = Map();
  const PlotLayout before = LayoutOf(plot);
  for (int i = 0; i < 6; ++i) plot.legend.push_back({LegendEntry::Mark::kArrow, {0, 0, 0}, "another entry"});
  const PlotLayout layout = LayoutOf(plot);
  EXPECT_EQ(layout.width, before.width);
  EXPECT_GT(layout.height, before.height);
  for (size_t i = 0; i < plot.legend.size(); ++i) {
    const int width = kLegendMarkWidth + TextWidth(plot.legend[i].text, kLabelStyle);
    EXPECT_LE(layout.legend[i].x + width, layout.width) << i;
    for (size_t k = 0; k < i; ++k) {
      const bool is_beside =
          layout.legend[i].y != layout.legend[k].y || layout.legend[i].x >= layout.legend[k].x + kLegendMarkWidth;
      EXPECT_TRUE(is_beside) << i << " " << k;
    }
  }
  const Image<Rgb> picture = FramedPlot(plot);
  EXPECT_FALSE(HasInk(picture, {picture.cols - 4, 0, 4, picture.rows}));
  EXPECT_FALSE(HasInk(picture, {0, picture.rows - 4, picture.cols, 4}));
}

TEST(FramedPlot, SmallPlotsAndLongTitlesKeepTheirTexts) {
  Plot plot;
  plot.pixels = Image<Rgb>(1, 1, kGreen);
  plot.title = "A title that is much longer than its plot is wide";
  const Image<Rgb> picture = FramedPlot(plot);
  EXPECT_GE(picture.cols, TextWidth(plot.title, kTitleStyle));
  EXPECT_EQ(CountPixels(picture, kGreen), 1);
  EXPECT_FALSE(HasInk(picture, {picture.cols - 4, 0, 4, picture.rows}));
}

TEST(FramedPlot, SameBytesEachTime) { EXPECT_EQ(FramedPlot(Map()).pixels, FramedPlot(Map()).pixels); }

TEST(TickValues, AreRoundAndInTheAxisDirection) {
  EXPECT_THAT(TickValues({.name = "", .unit = "", .first = 0.0, .last = 1.0}, 6),
              ElementsAre(0.0, DoubleNear(0.2, 1e-9), DoubleNear(0.4, 1e-9), DoubleNear(0.6, 1e-9),
                          DoubleNear(0.8, 1e-9), 1.0));
  EXPECT_THAT(TickValues({.name = "", .unit = "deg", .first = 180.0, .last = -180.0}, 10),
              ElementsAre(180.0, 135.0, 90.0, 45.0, 0.0, -45.0, -90.0, -135.0, -180.0));
  EXPECT_THAT(TickValues({.name = "", .unit = "m", .first = -7.3, .last = 13.1}, 5), ElementsAre(-5.0, 0.0, 5.0, 10.0));
}

TEST(TickValues, NothingToDivideGivesNone) {
  EXPECT_TRUE(TickValues({.name = "", .unit = "", .first = 2.0, .last = 2.0}, 5).empty());
  EXPECT_TRUE(TickValues({.name = "", .unit = "", .first = 0.0, .last = std::nan("")}, 5).empty());
  EXPECT_TRUE(TickValues({.name = "", .unit = "", .first = 0.0, .last = INFINITY}, 5).empty());
}

TEST(ScaleBar, IsRoundInEachUnit) {
  EXPECT_EQ(ScaleBarText({.name = "azimuth", .unit = "deg", .first = 180.0, .last = -180.0}), "90 deg");
  EXPECT_EQ(ScaleBarText({.name = "x", .unit = "m", .first = 0.0, .last = 0.9}), "0.2 m");
  EXPECT_EQ(ScaleBarText({.name = "x", .unit = "m", .first = 0.0, .last = 1500.0}), "200 m");
}

}  // namespace
}  // namespace curvereg
