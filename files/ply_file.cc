// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/ply_file.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "absl/strings/str_cat.h"
#include "files/file_bytes.h"
#include "files/ply_header.h"
#include "files/point_output.h"
#include "files/read_progress.h"
#include "files/text_fields.h"

namespace curvereg {
namespace {

absl::Status Truncated(const PlyElement& element) {
  return absl::DataLossError(absl::StrCat("truncated, or wrong header: PLY header declares ", element.count, " ",
                                          Quoted(element.name), ", the file ends before the last"));
}

// 0, 1, 2 for x, y, z; 3 for what is skipped.
std::size_t AxisOf(const PlyProperty& property) {
  if (property.list_count_type.has_value() || property.name.size() != 1) return 3;
  return std::min<std::size_t>(std::string_view("xyz").find(property.name[0]), 3);
}

template <typename T>
double Load(const char* bytes, bool is_big_endian) {
  return static_cast<double>(is_big_endian ? LoadBigEndian<T>(bytes) : LoadLittleEndian<T>(bytes));
}

double LoadNumber(const char* bytes, PlyType type, bool is_big_endian) {
  switch (type) {
    case PlyType::kInt8:
      return Load<int8_t>(bytes, is_big_endian);
    case PlyType::kUint8:
      return Load<uint8_t>(bytes, is_big_endian);
    case PlyType::kInt16:
      return Load<int16_t>(bytes, is_big_endian);
    case PlyType::kUint16:
      return Load<uint16_t>(bytes, is_big_endian);
    case PlyType::kInt32:
      return Load<int32_t>(bytes, is_big_endian);
    case PlyType::kUint32:
      return Load<uint32_t>(bytes, is_big_endian);
    case PlyType::kFloat32:
      return Load<float>(bytes, is_big_endian);
    case PlyType::kFloat64:
      return Load<double>(bytes, is_big_endian);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

// The data of a binary file, taken from the front; every take is checked.
class BinaryBody {
 public:
  BinaryBody(std::string_view bytes, bool is_big_endian) : rest_(bytes), is_big_endian_(is_big_endian) {}

  // True when `count` elements can be there, by the least bytes that they take.
  bool CanHold(const PlyElement& element) const {
    const std::size_t size = PlyMinBytes(element);
    return size == 0 || element.count <= rest_.size() / size;
  }

  // Nullopt at the end of the data.
  std::optional<double> Number(PlyType type) {
    const std::size_t size = PlyTypeSize(type);
    if (rest_.size() < size) return std::nullopt;
    const double number = LoadNumber(rest_.data(), type, is_big_endian_);
    rest_.remove_prefix(size);
    return number;
  }

  // Passes over `count` numbers; false when there are fewer.
  bool Skip(PlyType type, std::size_t count) {
    const std::size_t size = PlyTypeSize(type);
    if (count > rest_.size() / size) return false;
    rest_.remove_prefix(count * size);
    return true;
  }

 private:
  std::string_view rest_;
  bool is_big_endian_;
};

// The same for the data of an ascii file.
class AsciiBody {
 public:
  explicit AsciiBody(std::string_view text) : rest_(text) {}

  bool CanHold(const PlyElement& element) const {
    const std::size_t columns = element.properties.size();
    return columns == 0 || element.count <= (rest_.size() + 1) / (2 * columns);
  }

  // Nullopt at the end of the data, or where there is something else than a number.
  std::optional<double> Number(PlyType) {
    const std::string_view field = NextAnywhere();
    // As float32 at once: through double it would be rounded twice.
    if (const std::optional<float> value = ParseFloat(field)) return static_cast<double>(*value);
    return std::nullopt;
  }

  bool Skip(PlyType, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      if (NextAnywhere().empty()) return false;
    }
    return true;
  }

 private:
  std::string_view NextAnywhere() {
    while (!rest_.empty() && IsSpace(rest_.front())) rest_.remove_prefix(1);
    std::size_t end = 0;
    while (end < rest_.size() && !IsSpace(rest_[end])) ++end;
    const std::string_view field = rest_.substr(0, end);
    rest_.remove_prefix(end);
    return field;
  }

  static bool IsSpace(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

  std::string_view rest_;
};

// Reads one element; x, y, z go to `point`. False when the data end first or are not numbers.
template <typename Body>
bool ReadElement(const PlyElement& element, Body& body, Eigen::Vector3f& point) {
  for (const PlyProperty& property : element.properties) {
    const std::size_t axis = AxisOf(property);
    if (axis == 3) {
      std::optional<double> count = 1.0;
      if (property.list_count_type.has_value()) count = body.Number(*property.list_count_type);
      if (!count.has_value() || !(*count >= 0.0 && *count <= std::numeric_limits<uint32_t>::max())) return false;
      if (!body.Skip(property.type, static_cast<std::size_t>(*count))) return false;
      continue;
    }
    const std::optional<double> value = body.Number(property.type);
    if (!value.has_value()) return false;
    point[static_cast<Eigen::Index>(axis)] = static_cast<float>(*value);
  }
  return true;
}

template <typename Body>
bool SkipElements(const PlyElement& element, Body& body) {
  // Nothing is stored of an element without properties, however many the header declares.
  if (element.properties.empty()) return true;
  Eigen::Vector3f unused;
  for (std::size_t i = 0; i < element.count; ++i) {
    if (!ReadElement(element, body, unused)) return false;
  }
  return true;
}

template <typename Body>
absl::StatusOr<Scan> ReadVertices(const PlyHeader& header, Body body, const CloudReadOptions& options) {
  for (const PlyElement& element : header.elements) {
    if (!body.CanHold(element)) return Truncated(element);
    if (element.name != "vertex") {
      if (!SkipElements(element, body)) return Truncated(element);
      continue;
    }
    if (element.count > static_cast<uint64_t>(std::max<int64_t>(options.max_points, 0))) {
      return absl::ResourceExhaustedError(
          absl::StrCat("contains ", element.count, " points, more than the limit of ", options.max_points));
    }
    Scan scan;
    scan.points.resize(element.count);
    ReadProgress progress(options, element.count);
    for (std::size_t i = 0; i < element.count; ++i) {
      if (!ReadElement(element, body, scan.points[i])) {
        return absl::DataLossError(
            absl::StrCat("vertex ", i, " of ", element.count, " is missing or not a number: truncated or corrupt"));
      }
      progress.At(i);
    }
    return scan;
  }
  return absl::InternalError("PLY header without vertex");
}

}  // namespace

bool LooksLikePly(std::string_view bytes) { return bytes.starts_with("ply\n") || bytes.starts_with("ply\r\n"); }

absl::StatusOr<Scan> ParsePly(std::string_view bytes, const CloudReadOptions& options) {
  const absl::StatusOr<PlyHeader> header = ParsePlyHeader(bytes);
  if (!header.ok()) return header.status();
  const std::string_view body = bytes.substr(header->header_bytes);
  if (header->format == PlyFormat::kAscii) return ReadVertices(*header, AsciiBody(body), options);
  return ReadVertices(*header, BinaryBody(body, header->format == PlyFormat::kBinaryBigEndian), options);
}

void AppendPly(const Scan& scan, CloudEncoding encoding, AtomicFile& file) {
  file.Append(absl::StrCat("ply\nformat ", encoding == CloudEncoding::kAscii ? "ascii" : "binary_little_endian",
                           " 1.0\nelement vertex ", scan.points.size(),
                           "\nproperty float x\nproperty float y\nproperty float z\nend_header\n"));
  if (encoding == CloudEncoding::kAscii) return AppendTextPoints(scan, ' ', file);
  AppendPackedPoints(scan, file);
}

}  // namespace curvereg
