// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "render/png.h"

#include <png.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace curvereg {
namespace {

// Decodes with libpng as RGB.
Image<Rgb> Decode(const std::string& bytes) {
  png_image image;
  std::memset(&image, 0, sizeof image);
  image.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()) == 0) return {};
  image.format = PNG_FORMAT_RGB;
  Image<Rgb> picture(static_cast<int>(image.height), static_cast<int>(image.width));
  if (png_image_finish_read(&image, nullptr, picture.pixels.data(), 0, nullptr) == 0) return {};
  return picture;
}

// CIE lightness of an sRGB colour, in [0, 100].
double Lightness(const Rgb& colour) {
  const auto linear = [](uint8_t byte) {
    const double u = byte / 255.0;
    return u <= 0.04045 ? u / 12.92 : std::pow((u + 0.055) / 1.055, 2.4);
  };
  const double y = 0.2126 * linear(colour[0]) + 0.7152 * linear(colour[1]) + 0.0722 * linear(colour[2]);
  return y > 0.008856 ? 116.0 * std::cbrt(y) - 16.0 : 903.3 * y;
}

TEST(EncodePng, ColoursComeBack) {
  Image<Rgb> picture(3, 5);
  for (std::size_t i = 0; i < picture.size(); ++i) {
    picture.pixels[i] = {static_cast<uint8_t>(i), static_cast<uint8_t>(255 - i), static_cast<uint8_t>(7 * i)};
  }
  const auto bytes = EncodePng(picture);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  const Image<Rgb> back = Decode(*bytes);
  EXPECT_EQ(back.rows, 3);
  EXPECT_EQ(back.cols, 5);
  EXPECT_EQ(back.pixels, picture.pixels);
}

TEST(EncodePng, GreysComeBack) {
  Image<uint8_t> picture(2, 2);
  picture.pixels = {0, 100, 200, 255};
  const auto bytes = EncodePng(picture);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  EXPECT_EQ(Decode(*bytes).pixels[1], (Rgb{100, 100, 100}));
}

TEST(EncodePng, NoPixelsIsAnError) {
  EXPECT_EQ(EncodePng(Image<uint8_t>()).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST(HeightColour, LightnessRisesEvenly) {
  double previous = Lightness(HeightColour(0.0));
  EXPECT_LT(previous, 15.0);
  for (int i = 1; i <= 10; ++i) {
    const double lightness = Lightness(HeightColour(i / 10.0));
    EXPECT_NEAR(lightness - previous, 8.0, 3.0) << i;
    previous = lightness;
  }
  EXPECT_GT(previous, 85.0);
  EXPECT_EQ(HeightColour(-1.0), HeightColour(0.0));
  EXPECT_EQ(HeightColour(2.0), HeightColour(1.0));
  EXPECT_EQ(HeightColour(std::nan("")), HeightColour(0.0));
}

TEST(SignedColour, WhiteAtZeroAndDifferentEnds) {
  EXPECT_EQ(SignedColour(0.0), (Rgb{255, 255, 255}));
  EXPECT_EQ(SignedColour(std::nan("")), (Rgb{255, 255, 255}));
  EXPECT_GT(SignedColour(-1.0)[2], SignedColour(-1.0)[0]);
  EXPECT_GT(SignedColour(1.0)[0], SignedColour(1.0)[2]);
  EXPECT_EQ(SignedColour(-9.0), SignedColour(-1.0));
}

}  // namespace
}  // namespace curvereg
