// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/ply_header.h"

#include <algorithm>
#include <array>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "files/text_fields.h"

namespace curvereg {
namespace {

constexpr std::size_t kMaxElements = 1024;
constexpr std::size_t kMaxProperties = 1024;

std::optional<PlyType> TypeFromName(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, PlyType>, 16> kNames = {{{"char", PlyType::kInt8},
                                                                            {"int8", PlyType::kInt8},
                                                                            {"uchar", PlyType::kUint8},
                                                                            {"uint8", PlyType::kUint8},
                                                                            {"short", PlyType::kInt16},
                                                                            {"int16", PlyType::kInt16},
                                                                            {"ushort", PlyType::kUint16},
                                                                            {"uint16", PlyType::kUint16},
                                                                            {"int", PlyType::kInt32},
                                                                            {"int32", PlyType::kInt32},
                                                                            {"uint", PlyType::kUint32},
                                                                            {"uint32", PlyType::kUint32},
                                                                            {"float", PlyType::kFloat32},
                                                                            {"float32", PlyType::kFloat32},
                                                                            {"double", PlyType::kFloat64},
                                                                            {"float64", PlyType::kFloat64}}};
  for (const auto& [type_name, type] : kNames) {
    if (name == type_name) return type;
  }
  return std::nullopt;
}

absl::Status ParseFormat(std::string_view rest, PlyHeader& header) {
  const std::string_view word = NextField(rest);
  const std::string_view version = NextField(rest);
  if (word == "ascii") {
    header.format = PlyFormat::kAscii;
  } else if (word == "binary_little_endian") {
    header.format = PlyFormat::kBinaryLittleEndian;
  } else if (word == "binary_big_endian") {
    header.format = PlyFormat::kBinaryBigEndian;
  } else {
    return absl::InvalidArgumentError(absl::StrCat("unknown format ", Quoted(word)));
  }
  if (version != "1.0") return absl::InvalidArgumentError(absl::StrCat("version is ", Quoted(version), ", not 1.0"));
  return absl::OkStatus();
}

absl::Status ParseElement(std::string_view rest, PlyHeader& header) {
  PlyElement element;
  element.name = std::string(NextField(rest));
  const std::string_view number = NextField(rest);
  const std::optional<int64_t> count = ParseCount(number);
  if (element.name.empty() || !count.has_value()) {
    return absl::InvalidArgumentError(absl::StrCat("element count ", Quoted(number), " is not a whole number"));
  }
  if (header.elements.size() == kMaxElements) return absl::InvalidArgumentError("more than 1024 elements");
  element.count = static_cast<std::size_t>(*count);
  header.elements.push_back(std::move(element));
  return absl::OkStatus();
}

absl::Status ParseProperty(std::string_view rest, PlyHeader& header) {
  if (header.elements.empty()) return absl::InvalidArgumentError("property before any element");
  std::vector<PlyProperty>& properties = header.elements.back().properties;
  if (properties.size() == kMaxProperties) return absl::InvalidArgumentError("more than 1024 properties");
  PlyProperty property;
  std::string_view type_name = NextField(rest);
  if (type_name == "list") {
    const std::string_view count_name = NextField(rest);
    property.list_count_type = TypeFromName(count_name);
    if (!property.list_count_type.has_value() || *property.list_count_type >= PlyType::kFloat32) {
      return absl::InvalidArgumentError(absl::StrCat("list length of type ", Quoted(count_name)));
    }
    type_name = NextField(rest);
  }
  const std::optional<PlyType> type = TypeFromName(type_name);
  if (!type.has_value()) return absl::InvalidArgumentError(absl::StrCat("unknown type ", Quoted(type_name)));
  property.type = *type;
  property.name = std::string(NextField(rest));
  properties.push_back(std::move(property));
  return absl::OkStatus();
}

absl::Status ParseKey(std::string_view key, std::string_view rest, PlyHeader& header) {
  if (key == "element") return ParseElement(rest, header);
  if (key == "property") return ParseProperty(rest, header);
  if (key == "comment" || key == "obj_info" || key.empty()) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("unknown key ", Quoted(key)));
}

absl::Status CheckVertex(const PlyHeader& header) {
  const auto vertex = std::find_if(header.elements.begin(), header.elements.end(),
                                   [](const PlyElement& element) { return element.name == "vertex"; });
  if (vertex == header.elements.end()) return absl::InvalidArgumentError("PLY header: no element vertex");
  for (const char* name : {"x", "y", "z"}) {
    const auto named = std::count_if(
        vertex->properties.begin(), vertex->properties.end(),
        [&](const PlyProperty& property) { return property.name == name && !property.list_count_type.has_value(); });
    if (named != 1) {
      return absl::InvalidArgumentError(absl::StrCat("PLY header: element vertex has ", named, " properties ", name));
    }
  }
  return absl::OkStatus();
}

}  // namespace

std::size_t PlyTypeSize(PlyType type) {
  switch (type) {
    case PlyType::kInt8:
    case PlyType::kUint8:
      return 1;
    case PlyType::kInt16:
    case PlyType::kUint16:
      return 2;
    case PlyType::kInt32:
    case PlyType::kUint32:
    case PlyType::kFloat32:
      return 4;
    case PlyType::kFloat64:
      return 8;
  }
  return 8;
}

std::size_t PlyMinBytes(const PlyElement& element) {
  std::size_t size = 0;
  for (const PlyProperty& property : element.properties) {
    size += PlyTypeSize(property.list_count_type.value_or(property.type));
  }
  return size;
}

bool HasLists(const PlyElement& element) {
  return std::any_of(element.properties.begin(), element.properties.end(),
                     [](const PlyProperty& property) { return property.list_count_type.has_value(); });
}

absl::StatusOr<PlyHeader> ParsePlyHeader(std::string_view bytes) {
  LineReader lines(bytes);
  if (lines.Next() != "ply") return absl::InvalidArgumentError("PLY header does not begin with a line 'ply'");
  PlyHeader header;
  bool has_format = false;
  while (true) {
    const std::optional<std::string_view> line = lines.Next();
    if (!line.has_value()) return absl::DataLossError("PLY header ends before its end_header line: truncated");
    std::string_view rest = *line;
    const std::string_view key = NextField(rest);
    if (key == "end_header") break;
    has_format = has_format || key == "format";
    const absl::Status status = key == "format" ? ParseFormat(rest, header) : ParseKey(key, rest, header);
    if (!status.ok()) {
      return absl::InvalidArgumentError(absl::StrCat("PLY header line ", lines.line_number(), ": ", status.message()));
    }
  }
  header.header_bytes = lines.offset();
  if (!has_format) return absl::InvalidArgumentError("PLY header: no line 'format'");
  if (const absl::Status status = CheckVertex(header); !status.ok()) return status;
  return header;
}

}  // namespace curvereg
