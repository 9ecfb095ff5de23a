// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// How points lie in a packed block.
#ifndef CURVEREG_WIRE_POINT_LAYOUT_H_
#define CURVEREG_WIRE_POINT_LAYOUT_H_

#include <array>
#include <bit>
#include <cstdint>

#include "absl/status/status.h"
#include "curvereg/v1/point_cloud.pb.h"

namespace curvereg::wire {

static_assert(std::endian::native == std::endian::little, "packed blocks are little-endian and read as they are");

// Bytes of a number; 0 for types that we do not know.
uint32_t NumericSize(v1::NumericType type);

// Of the field; its count of 0 means 1.
inline uint32_t CountOf(const v1::PointField& field) { return field.count() == 0 ? 1 : field.count(); }

// Where the coordinates lie in a point.
struct PositionFields {
  std::array<uint32_t, 3> offsets = {0, 4, 8};  // of x, y, z [bytes]
  bool is_double = false;                       // FLOAT64; else FLOAT32
};

// INVALID_FIELD naming the field within the layout: what the comments of v1.PointLayout ask for does not hold.
absl::Status ValidateLayout(const v1::PointLayout& layout, uint64_t point_count);

// Precondition: the layout is valid.
PositionFields PositionsOf(const v1::PointLayout& layout);

// Bytes of the block; the greatest number where 64 bits do not hold it.
uint64_t LayoutBytes(const v1::PointLayout& layout, uint64_t point_count);

// float32 x y z and nothing else: how core holds a scan.
v1::PointLayout PackedFloatLayout();
bool IsPackedFloats(const v1::PointLayout& layout);

}  // namespace curvereg::wire

#endif  // CURVEREG_WIRE_POINT_LAYOUT_H_
