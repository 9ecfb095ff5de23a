// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/point_layout.h"

#include <limits>
#include <set>
#include <string>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "wire/error.h"
#include "wire/plain_text.h"

namespace curvereg::wire {
namespace {

constexpr int kMaxFields = 64;
constexpr size_t kMaxNameBytes = 64;
constexpr uint32_t kMaxStride = 1024;
constexpr const char* kAxes[] = {"x", "y", "z"};

uint64_t SaturatingProduct(uint64_t a, uint64_t b) {
  uint64_t product = 0;
  return __builtin_mul_overflow(a, b, &product) ? std::numeric_limits<uint64_t>::max() : product;
}

uint64_t EndOf(const v1::PointField& field) {
  return uint64_t{field.offset()} + uint64_t{NumericSize(field.type())} * CountOf(field);
}

const v1::PointField* FieldNamed(const v1::PointLayout& layout, std::string_view name) {
  for (const v1::PointField& field : layout.fields()) {
    if (field.name() == name) return &field;
  }
  return nullptr;
}

absl::Status ValidateField(const v1::PointField& field, uint32_t stride) {
  if (field.name().empty() || field.name().size() > kMaxNameBytes || !IsPlainText(field.name())) {
    return FieldError("name", absl::StrCat("must be 1 to ", kMaxNameBytes, " bytes of text"));
  }
  if (NumericSize(field.type()) == 0) return FieldError("type", "not a numeric type");
  if (EndOf(field) > stride) {
    return FieldError("offset", absl::StrCat("the field ends at byte ", EndOf(field), " of ", stride));
  }
  return absl::OkStatus();
}

// Of fields that are valid one by one.
absl::Status ValidatePositions(const v1::PointLayout& layout) {
  const v1::PointField* x = FieldNamed(layout, "x");
  for (const char* axis : kAxes) {
    const v1::PointField* field = FieldNamed(layout, axis);
    if (field == nullptr) return FieldError("fields", absl::StrCat("no field ", axis));
    const bool is_float = field->type() == v1::NUMERIC_TYPE_FLOAT32 || field->type() == v1::NUMERIC_TYPE_FLOAT64;
    if (!is_float || field->type() != x->type() || CountOf(*field) != 1) {
      return FieldError("fields", "x, y and z must be of one type, FLOAT32 or FLOAT64, of count 1");
    }
    for (const v1::PointField& other : layout.fields()) {
      if (&other != field && other.offset() < EndOf(*field) && field->offset() < EndOf(other)) {
        return FieldError("fields", absl::StrCat("field ", other.name(), " overlaps ", axis));
      }
    }
  }
  return absl::OkStatus();
}

absl::Status ValidateRows(const v1::PointLayout& layout, uint64_t point_count) {
  if (layout.width() == 0) {
    return layout.row_padding() == 0 ? absl::OkStatus() : FieldError("row_padding", "only of rows, that is with width");
  }
  if (point_count % layout.width() == 0) return absl::OkStatus();
  return FieldError("width", absl::StrCat("does not divide the number of points, ", point_count));
}

}  // namespace

uint32_t NumericSize(v1::NumericType type) {
  switch (type) {
    case v1::NUMERIC_TYPE_INT8:
    case v1::NUMERIC_TYPE_UINT8:
      return 1;
    case v1::NUMERIC_TYPE_INT16:
    case v1::NUMERIC_TYPE_UINT16:
      return 2;
    case v1::NUMERIC_TYPE_INT32:
    case v1::NUMERIC_TYPE_UINT32:
    case v1::NUMERIC_TYPE_FLOAT32:
      return 4;
    case v1::NUMERIC_TYPE_FLOAT64:
      return 8;
    default:
      return 0;
  }
}

absl::Status ValidateLayout(const v1::PointLayout& layout, uint64_t point_count) {
  if (layout.point_stride() == 0 || layout.point_stride() > kMaxStride) {
    return FieldError("point_stride", absl::StrCat("must be 1 to ", kMaxStride));
  }
  if (layout.fields_size() > kMaxFields) return FieldError("fields", absl::StrCat("more than ", kMaxFields));
  std::set<std::string_view> names;
  for (int i = 0; i < layout.fields_size(); ++i) {
    absl::Status status = ValidateField(layout.fields(i), layout.point_stride());
    if (status.ok() && !names.insert(layout.fields(i).name()).second) {
      status = FieldError("name", absl::StrCat("a second field ", layout.fields(i).name()));
    }
    if (!status.ok()) return WithinField(absl::StrCat("fields[", i, "]"), status);
  }
  const absl::Status positions = ValidatePositions(layout);
  return positions.ok() ? ValidateRows(layout, point_count) : positions;
}

PositionFields PositionsOf(const v1::PointLayout& layout) {
  PositionFields positions;
  for (size_t axis = 0; axis < 3; ++axis) {
    const v1::PointField* field = FieldNamed(layout, kAxes[axis]);
    positions.offsets[axis] = field->offset();
    positions.is_double = field->type() == v1::NUMERIC_TYPE_FLOAT64;
  }
  return positions;
}

uint64_t LayoutBytes(const v1::PointLayout& layout, uint64_t point_count) {
  if (layout.width() == 0) return SaturatingProduct(point_count, layout.point_stride());
  const uint64_t row_bytes = uint64_t{layout.width()} * layout.point_stride() + layout.row_padding();  // below 2^64
  return SaturatingProduct(point_count / layout.width(), row_bytes);
}

v1::PointLayout PackedFloatLayout() {
  v1::PointLayout layout;
  uint32_t offset = 0;
  for (const char* axis : kAxes) {
    v1::PointField* field = layout.add_fields();
    field->set_name(axis);
    field->set_offset(offset);
    field->set_type(v1::NUMERIC_TYPE_FLOAT32);
    field->set_count(1);
    offset += sizeof(float);
  }
  layout.set_point_stride(offset);
  return layout;
}

bool IsPackedFloats(const v1::PointLayout& layout) {
  const PositionFields positions = PositionsOf(layout);
  return !positions.is_double && positions.offsets == PositionFields().offsets &&
         layout.point_stride() == 3 * sizeof(float) && layout.row_padding() == 0;
}

}  // namespace curvereg::wire
