// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "render/canvas.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace curvereg {
namespace {

constexpr Rgb kWhite = {255, 255, 255};
constexpr Rgb kBlack = {0, 0, 0};
constexpr Rgb kRed = {200, 0, 0};

// The smallest rectangle around all pixels that are not white; empty without any.
PixelRect InkOf(const Image<Rgb>& picture) {
  int left = picture.cols, top = picture.rows, right = -1, bottom = -1;
  for (int row = 0; row < picture.rows; ++row) {
    for (int col = 0; col < picture.cols; ++col) {
      if (picture(row, col) == kWhite) continue;
      left = std::min(left, col);
      right = std::max(right, col);
      top = std::min(top, row);
      bottom = std::max(bottom, row);
    }
  }
  return right < 0 ? PixelRect{} : PixelRect{left, top, right - left + 1, bottom - top + 1};
}

TEST(Canvas, ALineGoesFromPixelToPixel) {
  Image<Rgb> picture(20, 40, kWhite);
  Canvas(picture).Line({5.0, 10.0}, {30.0, 10.0}, kRed);
  for (int col = 5; col <= 30; ++col) EXPECT_LT(picture(10, col)[1], 128) << col;
  for (const auto& [row, col] : {std::pair(10, 2), {10, 33}, {7, 15}, {13, 15}}) {
    EXPECT_EQ(picture(row, col), kWhite) << row << " " << col;
  }
}

TEST(Canvas, CirclesHaveTheirRadiusAndSubpixelCentres) {
  Image<Rgb> picture(101, 101, kWhite);
  Canvas(picture).Circle({50.0, 50.0}, 30.0, kRed, 2);
  for (int row = 0; row < 101; ++row) {
    for (int col = 0; col < 101; ++col) {
      const double distance = std::hypot(row - 50.0, col - 50.0);
      if (std::abs(distance - 30.0) < 0.5) {
        EXPECT_LT(picture(row, col)[1], 140) << row << " " << col;
      }
      if (std::abs(distance - 30.0) > 3.5) {
        EXPECT_EQ(picture(row, col), kWhite) << row << " " << col;
      }
    }
  }
  Image<Rgb> disc(21, 21, kWhite);
  Canvas(disc).Disc({10.0, 10.0}, 6.0, kRed);
  EXPECT_EQ(disc(10, 10), kRed);
  EXPECT_EQ(disc(10, 1), kWhite);
}

TEST(Canvas, ArrowsAreWiderAtTheirTip) {
  Image<Rgb> picture(41, 101, kWhite);
  Canvas(picture).Arrow({10.0, 20.0}, {90.0, 20.0}, kRed, 1);
  const auto ink_in_column = [&](int col) {
    int count = 0;
    for (int row = 0; row < picture.rows; ++row) count += picture(row, col)[1] < 128 ? 1 : 0;
    return count;
  };
  EXPECT_LE(ink_in_column(20), 2);
  EXPECT_GE(ink_in_column(75), 3);  // the shaft and both barbs
}

TEST(Canvas, FillsAndOutlinesExactly) {
  Image<Rgb> picture(10, 12, kWhite);
  Canvas canvas(picture);
  canvas.Fill({2, 3, 4, 5}, kRed);
  EXPECT_EQ(std::count(picture.pixels.begin(), picture.pixels.end(), kRed), 20);
  EXPECT_EQ(picture(3, 2), kRed);
  EXPECT_EQ(picture(7, 5), kRed);
  canvas.Outline({0, 0, 12, 10}, kBlack);
  EXPECT_EQ(std::count(picture.pixels.begin(), picture.pixels.end(), kBlack), 2 * 12 + 2 * 8);
}

TEST(Canvas, TextIsAsHighAndWideAsPromised) {
  const TextStyle style = {.height_px = 20};
  Image<Rgb> picture(100, 400, kWhite);
  Canvas(picture).Text({50.0, 40.0}, TextAnchor::kBegin, "HEIGHT", style);
  const PixelRect ink = InkOf(picture);
  EXPECT_NEAR(ink.left, 50, 4);
  EXPECT_NEAR(ink.width, TextWidth("HEIGHT", style), 8);
  EXPECT_NEAR(ink.top, 30, 3);
  EXPECT_NEAR(ink.height, 20, 4);
}

TEST(Canvas, TextIsAnchoredAndTurned) {
  const TextStyle style = {.height_px = 20};
  Image<Rgb> middle(100, 400, kWhite), end(100, 400, kWhite), upward(400, 100, kWhite);
  Canvas(middle).Text({200.0, 50.0}, TextAnchor::kMiddle, "HEIGHT", style);
  EXPECT_NEAR(InkOf(middle).left + 0.5 * InkOf(middle).width, 200.0, 4.0);
  Canvas(end).Text({300.0, 50.0}, TextAnchor::kEnd, "HEIGHT", style);
  EXPECT_NEAR(InkOf(end).left + InkOf(end).width, 300, 4);
  Canvas(upward).Text({50.0, 300.0}, TextAnchor::kBegin, "HEIGHT", {.height_px = 20, .is_upward = true});
  const PixelRect ink = InkOf(upward);
  EXPECT_NEAR(ink.top + ink.height, 300, 4);
  EXPECT_EQ(ink.height, InkOf(end).width);
  EXPECT_EQ(ink.width, InkOf(end).height);
}

TEST(Canvas, WhatLiesOutsideIsCutOff) {
  Image<Rgb> picture(10, 10, kWhite);
  Canvas canvas(picture);
  canvas.Line({-50.0, 5.0}, {50.0, 5.0}, kRed);
  canvas.Circle({0.0, 0.0}, 100.0, kRed);
  canvas.Arrow({-5.0, -5.0}, {-50.0, -50.0}, kRed);
  canvas.Fill({8, 8, 100, 100}, kBlack);
  canvas.Text({0.0, 0.0}, TextAnchor::kMiddle, "outside", {});
  canvas.Text({500.0, -500.0}, TextAnchor::kBegin, "outside", {});
  EXPECT_EQ(picture(9, 9), kBlack);
  EXPECT_LT(picture(5, 1)[1], 128);
}

TEST(Canvas, PastesPictures) {
  Image<Rgb> picture(6, 8, kWhite);
  Canvas(picture).Paste(Image<Rgb>(2, 3, kRed), 4, 1);
  EXPECT_EQ(InkOf(picture).left, 4);
  EXPECT_EQ(InkOf(picture).top, 1);
  EXPECT_EQ(std::count(picture.pixels.begin(), picture.pixels.end(), kRed), 6);
  Canvas(picture).Paste(Image<Rgb>(), 0, 0);
}

TEST(Zoomed, RepeatsEachPixel) {
  Image<Rgb> picture(3, 5);
  for (std::size_t i = 0; i < picture.size(); ++i) picture.pixels[i] = {static_cast<uint8_t>(i), 7, 0};
  for (const int zoom : {1, 2, 3}) {
    const Image<Rgb> zoomed = Zoomed(picture, zoom);
    ASSERT_EQ(zoomed.rows, 3 * zoom);
    ASSERT_EQ(zoomed.cols, 5 * zoom);
    for (int row = 0; row < zoomed.rows; ++row) {
      for (int col = 0; col < zoomed.cols; ++col) EXPECT_EQ(zoomed(row, col), picture(row / zoom, col / zoom));
    }
  }
  EXPECT_TRUE(Zoomed(Image<Rgb>(), 3).empty());
}

TEST(FlippedRows, TwiceIsNothing) {
  Image<Rgb> picture(3, 2);
  for (std::size_t i = 0; i < picture.size(); ++i) picture.pixels[i] = {static_cast<uint8_t>(i), 0, 0};
  EXPECT_EQ(FlippedRows(picture)(0, 0), picture(2, 0));
  EXPECT_EQ(FlippedRows(FlippedRows(picture)).pixels, picture.pixels);
}

}  // namespace
}  // namespace curvereg
