// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/pcd_header.h"

#include <algorithm>
#include <optional>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "files/text_fields.h"

namespace curvereg {
namespace {

constexpr std::size_t kMaxFields = 1024;
constexpr int64_t kMaxCount = 1'000'000;

// The header as read, before it is known to make sense.
struct RawHeader {
  std::vector<std::string_view> names;
  std::vector<std::string_view> sizes;
  std::vector<std::string_view> types;
  std::vector<std::string_view> counts;
  std::optional<int64_t> width;
  std::optional<int64_t> height;
  std::optional<int64_t> points;
};

absl::Status LineError(int64_t line, absl::string_view cause) {
  return absl::InvalidArgumentError(absl::StrCat("PCD header line ", line, ": ", cause));
}

std::vector<std::string_view> Fields(std::string_view rest) {
  std::vector<std::string_view> fields;
  for (std::string_view field = NextField(rest); !field.empty(); field = NextField(rest)) fields.push_back(field);
  return fields;
}

absl::Status ParseInteger(absl::string_view key, const std::vector<std::string_view>& values,
                          std::optional<int64_t>& number) {
  number = values.size() == 1 ? ParseCount(values[0]) : std::nullopt;
  if (number.has_value()) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(key, " is not one whole number"));
}

absl::Status ParseData(const std::vector<std::string_view>& values, PcdData& data) {
  const std::string_view word = values.size() == 1 ? values[0] : std::string_view();
  if (word == "ascii") {
    data = PcdData::kAscii;
  } else if (word == "binary") {
    data = PcdData::kBinary;
  } else if (word == "binary_compressed") {
    data = PcdData::kBinaryCompressed;
  } else {
    return absl::InvalidArgumentError(
        absl::StrCat("DATA is ", Quoted(word), ", not ascii, binary or binary_compressed"));
  }
  return absl::OkStatus();
}

absl::Status ParseKey(std::string_view key, std::vector<std::string_view> values, RawHeader& raw) {
  if (key == "FIELDS" || key == "COLUMNS") {
    raw.names = std::move(values);
  } else if (key == "SIZE") {
    raw.sizes = std::move(values);
  } else if (key == "TYPE") {
    raw.types = std::move(values);
  } else if (key == "COUNT") {
    raw.counts = std::move(values);
  } else if (key == "WIDTH") {
    return ParseInteger("WIDTH", values, raw.width);
  } else if (key == "HEIGHT") {
    return ParseInteger("HEIGHT", values, raw.height);
  } else if (key == "POINTS") {
    return ParseInteger("POINTS", values, raw.points);
  } else if (key != "VERSION" && key != "VIEWPOINT") {
    return absl::InvalidArgumentError(absl::StrCat("unknown key ", Quoted(key)));
  }
  return absl::OkStatus();
}

absl::StatusOr<PcdField> MakeField(const RawHeader& raw, std::size_t i) {
  PcdField field;
  field.name = std::string(raw.names[i]);
  const std::optional<int64_t> size = ParseCount(raw.sizes[i]);
  const std::optional<int64_t> count = raw.counts.empty() ? 1 : ParseCount(raw.counts[i]);
  if (!size.has_value() || (*size != 1 && *size != 2 && *size != 4 && *size != 8)) {
    return absl::InvalidArgumentError(absl::StrCat("PCD header: SIZE ", Quoted(raw.sizes[i]), " is not 1, 2, 4 or 8"));
  }
  if (raw.types[i] != "F" && raw.types[i] != "I" && raw.types[i] != "U") {
    return absl::InvalidArgumentError(absl::StrCat("PCD header: TYPE ", Quoted(raw.types[i]), " is not F, I or U"));
  }
  if (!count.has_value() || *count < 1 || *count > kMaxCount) {
    return absl::InvalidArgumentError(
        absl::StrCat("PCD header: COUNT ", Quoted(raw.counts[i]), " is not in [1, ", kMaxCount, "]"));
  }
  field.type = raw.types[i][0];
  field.size = static_cast<std::size_t>(*size);
  field.count = static_cast<std::size_t>(*count);
  return field;
}

absl::Status FillFields(const RawHeader& raw, PcdHeader& header) {
  const std::size_t num_fields = raw.names.size();
  if (num_fields == 0) return absl::InvalidArgumentError("PCD header: FIELDS is missing");
  if (num_fields > kMaxFields) return absl::InvalidArgumentError("PCD header: more than 1024 fields");
  if (raw.sizes.size() != num_fields || raw.types.size() != num_fields ||
      (!raw.counts.empty() && raw.counts.size() != num_fields)) {
    return absl::InvalidArgumentError("PCD header: FIELDS, SIZE, TYPE and COUNT differ in length");
  }
  for (std::size_t i = 0; i < num_fields; ++i) {
    absl::StatusOr<PcdField> field = MakeField(raw, i);
    if (!field.ok()) return field.status();
    field->offset = header.point_bytes;
    field->column = header.point_columns;
    header.point_bytes += field->size * field->count;
    header.point_columns += field->count;
    header.fields.push_back(*std::move(field));
  }
  return absl::OkStatus();
}

absl::Status FindCoordinates(PcdHeader& header) {
  constexpr std::array<absl::string_view, 3> kNames = {"x", "y", "z"};
  for (std::size_t axis = 0; axis < kNames.size(); ++axis) {
    const auto found = std::find_if(header.fields.begin(), header.fields.end(), [&](const PcdField& field) {
      return absl::string_view(field.name) == kNames[axis];
    });
    if (found == header.fields.end()) {
      return absl::InvalidArgumentError(absl::StrCat("PCD header: no field ", kNames[axis]));
    }
    if (found->type != 'F' || found->size < 4 || found->count != 1) {
      return absl::InvalidArgumentError(
          absl::StrCat("PCD header: field ", kNames[axis], " is not one float of 4 or 8 bytes"));
    }
    header.xyz[axis] = static_cast<std::size_t>(found - header.fields.begin());
  }
  return absl::OkStatus();
}

absl::Status FillNumPoints(const RawHeader& raw, PcdHeader& header) {
  std::optional<int64_t> product;
  if (raw.width.has_value()) {
    int64_t value = 0;
    if (__builtin_mul_overflow(*raw.width, raw.height.value_or(1), &value)) {
      return absl::DataLossError("PCD header: WIDTH x HEIGHT is larger than any file");
    }
    product = value;
  }
  if (!raw.points.has_value() && !product.has_value()) {
    return absl::DataLossError("PCD header: neither POINTS nor WIDTH gives the number of points");
  }
  if (raw.points.has_value() && product.has_value() && *raw.points != *product) {
    return absl::DataLossError(
        absl::StrCat("PCD header is inconsistent: POINTS ", *raw.points, ", WIDTH x HEIGHT ", *product));
  }
  header.num_points = static_cast<std::size_t>(raw.points.has_value() ? *raw.points : *product);
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<PcdHeader> ParsePcdHeader(std::string_view bytes) {
  LineReader lines(bytes);
  RawHeader raw;
  PcdHeader header;
  bool has_data = false;
  while (!has_data) {
    const std::optional<std::string_view> line = lines.Next();
    if (!line.has_value()) return absl::DataLossError("PCD header ends before its DATA line: truncated");
    std::string_view rest = *line;
    const std::string_view key = NextField(rest);
    if (key.empty() || key[0] == '#') continue;
    has_data = key == "DATA";
    const absl::Status status = has_data ? ParseData(Fields(rest), header.data) : ParseKey(key, Fields(rest), raw);
    if (!status.ok()) return LineError(lines.line_number(), status.message());
  }
  header.header_bytes = lines.offset();
  header.header_lines = lines.line_number();
  for (const absl::Status& status : {FillFields(raw, header), FindCoordinates(header), FillNumPoints(raw, header)}) {
    if (!status.ok()) return status;
  }
  return header;
}

}  // namespace curvereg
