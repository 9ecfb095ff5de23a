// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "render/stage_pictures.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace curvereg {
namespace {

TEST(ValuePlot, InvalidPixelsAreGreyAndValuesSpanTheColours) {
  Image<float> values(1, 101);
  for (int col = 0; col < 101; ++col) values(0, col) = static_cast<float>(col);
  Image<uint8_t> valid(1, 101, 1);
  valid(0, 50) = 0;
  const Plot plot = ValuePlot(values, valid);
  const Image<Rgb>& picture = plot.pixels;
  EXPECT_EQ(picture(0, 0), HeightColour(0.0));
  EXPECT_EQ(picture(0, 100), HeightColour(1.0));
  EXPECT_EQ(picture(0, 50), (Rgb{128, 128, 128}));
  EXPECT_EQ(plot.colour_bar->low, 1.0);  // the 2nd and the 98th percentile of 100 values
  EXPECT_EQ(plot.colour_bar->high, 98.0);
}

TEST(ValuePlot, ZoomRepeatsPixels) {
  Image<float> values(2, 3, 5.0F);
  const Image<Rgb> picture = ValuePlot(values, Image<uint8_t>(2, 3, 1), 4).pixels;
  EXPECT_EQ(picture.rows, 8);
  EXPECT_EQ(picture.cols, 12);
}

TEST(ValuePlot, NothingValidAndNothingFiniteAreNoFault) {
  const Image<float> values(2, 2, std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(ValuePlot(values, Image<uint8_t>(2, 2, 0)).pixels(1, 1), (Rgb{128, 128, 128}));
  EXPECT_EQ(ValuePlot(values, Image<uint8_t>(2, 2, 1)).pixels(1, 1), HeightColour(0.0));
  EXPECT_EQ(SignedPlot(values).pixels(0, 0), (Rgb{255, 255, 255}));
  EXPECT_TRUE(SignedPlot(Image<float>()).pixels.empty());
}

TEST(SignedPlot, SignGivesTheColourAndZeroIsWhite) {
  Image<float> values(1, 3);
  values.pixels = {-2.0F, 0.0F, 2.0F};
  const Plot plot = SignedPlot(values);
  const Image<Rgb>& picture = plot.pixels;
  EXPECT_EQ(picture(0, 0), SignedColour(-1.0));
  EXPECT_EQ(picture(0, 1), SignedColour(0.0));
  EXPECT_EQ(picture(0, 2), SignedColour(1.0));
  EXPECT_EQ(plot.colour_bar->low, -2.0);
  EXPECT_EQ(plot.colour_bar->high, 2.0);
  EXPECT_EQ(plot.colour_bar->colour(0.0), SignedColour(-1.0));
}

TEST(KeypointPlot, CirclesAroundThePointOnly) {
  const Keypoint maximum{.row = 20.0F, .col = 30.0F, .level = 4, .response = 1.0F};
  const Image<Rgb> plain = KeypointPlot(Image<float>(40, 60), {}, 6).pixels;
  const Image<Rgb> marked = KeypointPlot(Image<float>(40, 60), {maximum}, 6).pixels;
  int num_changed = 0;
  for (int row = 0; row < 40; ++row) {
    for (int col = 0; col < 60; ++col) {
      if (marked(row, col) == plain(row, col)) continue;
      ++num_changed;
      EXPECT_NEAR(std::hypot(row - 20.0, col - 30.0), 1.5, 1.0);
      EXPECT_GT(marked(row, col)[0], marked(row, col)[2]);  // red: a maximum
    }
  }
  EXPECT_GE(num_changed, 6);
}

TEST(KeypointPlot, CoarseLevelsHaveLargeCirclesAndTheBorderCutsThem) {
  const Keypoint fine{.row = 32.0F, .col = 32.0F, .level = 4, .response = -1.0F};
  const Keypoint coarse{.row = 32.0F, .col = 32.0F, .level = 1, .response = -1.0F};
  const auto count = [](const Image<Rgb>& picture) {
    return std::count_if(picture.pixels.begin(), picture.pixels.end(), [](const Rgb& c) { return c[2] > c[0]; });
  };
  EXPECT_GT(count(KeypointPlot(Image<float>(64, 64), {coarse}, 6).pixels),
            4 * count(KeypointPlot(Image<float>(64, 64), {fine}, 6).pixels));
  const Keypoint corner{.row = 0.0F, .col = 0.0F, .level = 1, .response = 1.0F};
  EXPECT_EQ(KeypointPlot(Image<float>(8, 8), {corner}, 6).pixels.rows, 8);
}

}  // namespace
}  // namespace curvereg
