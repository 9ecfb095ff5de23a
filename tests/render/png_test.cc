// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "render/png.h"

#include <png.h>

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

}  // namespace
}  // namespace curvereg
