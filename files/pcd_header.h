// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The text header of a PCD file.
#ifndef CURVEREG_FILES_PCD_HEADER_H_
#define CURVEREG_FILES_PCD_HEADER_H_

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace curvereg {

enum class PcdData { kAscii, kBinary, kBinaryCompressed };

struct PcdField {
  std::string name;
  char type = 'F';         // F, I or U
  std::size_t size = 4;    // bytes of one value: 1, 2, 4 or 8
  std::size_t count = 1;   // values per point
  std::size_t offset = 0;  // of the first value from the start of the point [bytes]
  std::size_t column = 0;  // of the first value among the values of the point
};

struct PcdHeader {
  std::vector<PcdField> fields;
  std::array<std::size_t, 3> xyz{};  // indices of x, y, z in `fields`; each of type F, size 4 or 8, count 1
  std::size_t num_points = 0;
  std::size_t point_bytes = 0;    // sum of size * count; at most a few gigabytes, so products fit 64 bits with care
  std::size_t point_columns = 0;  // sum of count
  PcdData data = PcdData::kAscii;
  std::size_t header_bytes = 0;  // where the data begin
  int64_t header_lines = 0;
};

// INVALID_ARGUMENT: not a PCD header, or one without usable x, y, z; DATA_LOSS: cut off, or contradicting itself.
absl::StatusOr<PcdHeader> ParsePcdHeader(std::string_view bytes);

}  // namespace curvereg

#endif  // CURVEREG_FILES_PCD_HEADER_H_
