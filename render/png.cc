// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "render/png.h"

#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "absl/strings/str_cat.h"

namespace curvereg {
namespace {

// libpng's "simplified" interface reports errors by value; the other one jumps over destructors.
absl::StatusOr<std::string> Encode(int rows, int cols, png_uint_32 format, const void* pixels) {
  if (rows <= 0 || cols <= 0) return absl::InvalidArgumentError("a picture without pixels");
  png_image image;
  std::memset(&image, 0, sizeof image);
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(cols);
  image.height = static_cast<png_uint_32>(rows);
  image.format = format;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string bytes(size, '\0');
  const bool ok = png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels, 0, nullptr) != 0;
  if (!ok) return absl::InternalError(absl::StrCat("PNG: ", image.message));
  bytes.resize(size);
  return bytes;
}

using Stops = std::array<std::array<double, 3>, 6>;

// Our own: lightness (CIE L*) 10, 26, 42, 58, 74, 90 at equal steps; hue from blue over green to yellow.
constexpr Stops kHeightStops = {
    {{19, 21, 72}, {28, 58, 123}, {23, 108, 132}, {44, 157, 111}, {141, 199, 62}, {252, 227, 71}}};

uint8_t ToByte(double value) { return static_cast<uint8_t>(std::lround(std::clamp(value, 0.0, 255.0))); }

}  // namespace

absl::StatusOr<std::string> EncodePng(const Image<uint8_t>& grey) {
  return Encode(grey.rows, grey.cols, PNG_FORMAT_GRAY, grey.pixels.data());
}

absl::StatusOr<std::string> EncodePng(const Image<Rgb>& picture) {
  static_assert(sizeof(Rgb) == 3);
  return Encode(picture.rows, picture.cols, PNG_FORMAT_RGB, picture.pixels.data());
}

Rgb HeightColour(double share) {
  const double position = (share > 0.0 ? std::min(share, 1.0) : 0.0) * (kHeightStops.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(position), kHeightStops.size() - 2);
  Rgb colour{};
  for (std::size_t c = 0; c < 3; ++c) {
    colour[c] =
        ToByte(std::lerp(kHeightStops[below][c], kHeightStops[below + 1][c], position - static_cast<double>(below)));
  }
  return colour;
}

Rgb SignedColour(double value) {
  const double v = std::isnan(value) ? 0.0 : std::clamp(value, -1.0, 1.0);
  const std::array<double, 3> end = v < 0.0 ? std::array<double, 3>{33, 70, 160} : std::array<double, 3>{178, 24, 43};
  Rgb colour{};
  for (std::size_t c = 0; c < 3; ++c) colour[c] = ToByte(std::lerp(255.0, end[c], std::abs(v)));
  return colour;
}

}  // namespace curvereg
