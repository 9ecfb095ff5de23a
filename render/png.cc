// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "render/png.h"

#include <png.h>

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

}  // namespace

absl::StatusOr<std::string> EncodePng(const Image<uint8_t>& grey) {
  return Encode(grey.rows, grey.cols, PNG_FORMAT_GRAY, grey.pixels.data());
}

absl::StatusOr<std::string> EncodePng(const Image<Rgb>& picture) {
  static_assert(sizeof(Rgb) == 3);
  return Encode(picture.rows, picture.cols, PNG_FORMAT_RGB, picture.pixels.data());
}

}  // namespace curvereg
