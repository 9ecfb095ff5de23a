// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/byte_shuffle.h"

#include <algorithm>

namespace curvereg::wire {
namespace {

// Points gone through together: with the greatest stride they still fit in the processor's second cache.
constexpr size_t kTile = 256;

}  // namespace

void ShuffleBytes(std::string_view points, size_t stride, char* planes) {
  const size_t num_points = points.size() / stride;
  for (size_t begin = 0; begin < num_points; begin += kTile) {
    const size_t end = std::min(num_points, begin + kTile);
    for (size_t j = 0; j < stride; ++j) {
      for (size_t i = begin; i < end; ++i) planes[j * num_points + i] = points[i * stride + j];
    }
  }
}

void UnshuffleBytes(std::string_view planes, size_t stride, char* points) {
  const size_t num_points = planes.size() / stride;
  for (size_t begin = 0; begin < num_points; begin += kTile) {
    const size_t end = std::min(num_points, begin + kTile);
    for (size_t j = 0; j < stride; ++j) {
      for (size_t i = begin; i < end; ++i) points[i * stride + j] = planes[j * num_points + i];
    }
  }
}

}  // namespace curvereg::wire
