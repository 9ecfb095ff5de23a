// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The text header of a PLY file.
#ifndef CURVEREG_FILES_PLY_HEADER_H_
#define CURVEREG_FILES_PLY_HEADER_H_

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace curvereg {

enum class PlyFormat { kAscii, kBinaryLittleEndian, kBinaryBigEndian };

enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

// Bytes of one number.
std::size_t PlyTypeSize(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;
  std::optional<PlyType> list_count_type;  // set: a list, its length stored as this type before its members
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::kAscii;
  std::vector<PlyElement> elements;  // in file order; one at least is "vertex" with single x, y, z
  std::size_t header_bytes = 0;      // where the data begin
};

// Bytes that one element takes at least in a binary file (lists empty); numbers that it takes at least in an ascii one.
std::size_t PlyMinBytes(const PlyElement& element);
bool HasLists(const PlyElement& element);

// INVALID_ARGUMENT: not a PLY header, or one without usable x, y, z; DATA_LOSS: cut off.
absl::StatusOr<PlyHeader> ParsePlyHeader(std::string_view bytes);

}  // namespace curvereg

#endif  // CURVEREG_FILES_PLY_HEADER_H_
