// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A dense row-major raster, the one image type of the pipeline. Pixel (row, col) has its centre at integer coordinates.
#ifndef CURVEREG_CORE_BASE_IMAGE_H_
#define CURVEREG_CORE_BASE_IMAGE_H_

#include <cassert>
#include <cstddef>
#include <vector>

namespace curvereg {

template <typename T>
struct Image {
  int rows = 0;
  int cols = 0;
  std::vector<T> pixels;  // rows * cols values, row after row

  Image() = default;
  Image(int num_rows, int num_cols, T value = T{})
      : rows(num_rows),
        cols(num_cols),
        pixels(static_cast<std::size_t>(num_rows) * static_cast<std::size_t>(num_cols), value) {}

  std::size_t size() const { return pixels.size(); }
  bool empty() const { return pixels.empty(); }
  bool Contains(int row, int col) const { return row >= 0 && row < rows && col >= 0 && col < cols; }

  T* Row(int row) { return pixels.data() + Index(row, 0); }
  const T* Row(int row) const { return pixels.data() + Index(row, 0); }

  // Precondition: Contains(row, col).
  T& operator()(int row, int col) {
    assert(Contains(row, col));
    return pixels[Index(row, col)];
  }
  const T& operator()(int row, int col) const {
    assert(Contains(row, col));
    return pixels[Index(row, col)];
  }

  std::size_t Index(int row, int col) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(col);
  }
};

}  // namespace curvereg

#endif  // CURVEREG_CORE_BASE_IMAGE_H_
