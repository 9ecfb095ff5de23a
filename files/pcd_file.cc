// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/pcd_file.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <string>

#include "absl/strings/str_cat.h"
#include "files/file_bytes.h"
#include "files/lzf.h"
#include "files/pcd_header.h"
#include "files/point_output.h"
#include "files/read_progress.h"
#include "files/text_fields.h"

namespace curvereg {
namespace {

absl::Status Truncated(const PcdHeader& header, absl::string_view found) {
  return absl::DataLossError(absl::StrCat("truncated, or wrong header: PCD header declares ", header.num_points,
                                          " points of ", header.point_bytes, " bytes, the file holds ", found));
}

absl::Status CheckMaxPoints(const PcdHeader& header, const CloudReadOptions& options) {
  if (header.num_points <= static_cast<uint64_t>(std::max<int64_t>(options.max_points, 0))) return absl::OkStatus();
  return absl::ResourceExhaustedError(
      absl::StrCat("contains ", header.num_points, " points, more than the limit of ", options.max_points));
}

// Where the three coordinates of point i begin: start[axis] + i * stride[axis].
struct Layout {
  std::array<std::size_t, 3> start{};
  std::array<std::size_t, 3> stride{};
  std::array<bool, 3> is_double{};
};

Scan ReadPoints(const char* data, const Layout& layout, std::size_t num_points, const CloudReadOptions& options) {
  Scan scan;
  scan.points.resize(num_points);
  ReadProgress progress(options, num_points);
  for (std::size_t i = 0; i < num_points; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const char* value = data + layout.start[axis] + i * layout.stride[axis];
      scan.points[i][static_cast<Eigen::Index>(axis)] =
          layout.is_double[axis] ? static_cast<float>(LoadLittleEndian<double>(value)) : LoadLittleEndian<float>(value);
    }
    progress.At(i);
  }
  return scan;
}

// One point after the other.
Layout InterleavedLayout(const PcdHeader& header) {
  Layout layout;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const PcdField& field = header.fields[header.xyz[axis]];
    layout.start[axis] = field.offset;
    layout.stride[axis] = header.point_bytes;
    layout.is_double[axis] = field.size == 8;
  }
  return layout;
}

// One field after the other, as compressed files have it.
Layout PlanarLayout(const PcdHeader& header) {
  Layout layout;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const PcdField& field = header.fields[header.xyz[axis]];
    layout.start[axis] = field.offset * header.num_points;
    layout.stride[axis] = field.size;
    layout.is_double[axis] = field.size == 8;
  }
  return layout;
}

bool IsPackedFloat32(const Layout& layout) {
  return layout.stride[0] == 12 && layout.start == std::array<std::size_t, 3>{0, 4, 8};
}

absl::StatusOr<Scan> ParseBinary(const PcdHeader& header, std::string_view data, const CloudReadOptions& options) {
  if (header.num_points > data.size() / header.point_bytes) {
    return Truncated(header, absl::StrCat(data.size(), " bytes of them"));
  }
  if (const absl::Status status = CheckMaxPoints(header, options); !status.ok()) return status;
  const std::string_view rest = data.substr(header.num_points * header.point_bytes);
  if (rest.size() >= header.point_bytes && rest.find_first_not_of('\0') != rest.npos) {
    return Truncated(header, absl::StrCat(data.size(), " bytes of them"));
  }
  const Layout layout = InterleavedLayout(header);
  if (!IsPackedFloat32(layout)) return ReadPoints(data.data(), layout, header.num_points, options);
  Scan scan;
  scan.points.resize(header.num_points);
  static_assert(sizeof(Eigen::Vector3f) == 12);
  if (header.num_points > 0) std::memcpy(scan.points.data()->data(), data.data(), header.num_points * 12);
  return scan;
}

absl::StatusOr<Scan> ParseCompressed(const PcdHeader& header, std::string_view data, const CloudReadOptions& options) {
  if (header.num_points == 0) return Scan{};
  if (data.size() < 8) return Truncated(header, absl::StrCat(data.size(), " compressed bytes"));
  const std::size_t compressed_size = LoadLittleEndian<uint32_t>(data.data());
  const std::size_t size = LoadLittleEndian<uint32_t>(data.data() + 4);
  data.remove_prefix(8);
  if (compressed_size > data.size()) {
    return Truncated(header, absl::StrCat(data.size(), " of ", compressed_size, " compressed bytes"));
  }
  // Compared by division: the product of two numbers from the file could wrap around.
  if (size % header.point_bytes != 0 || size / header.point_bytes != header.num_points) {
    return Truncated(header, absl::StrCat(size, " bytes when unpacked"));
  }
  if (const absl::Status status = CheckMaxPoints(header, options); !status.ok()) return status;
  const absl::StatusOr<std::string> unpacked = LzfDecompress(data.substr(0, compressed_size), size);
  if (!unpacked.ok()) return unpacked.status();
  return ReadPoints(unpacked->data(), PlanarLayout(header), header.num_points, options);
}

// The coordinates on one line of an ascii file.
absl::Status ParseAsciiPoint(const PcdHeader& header, std::string_view line, Eigen::Vector3f& point) {
  std::size_t num_columns = 0;
  std::string_view rest = line;
  for (std::string_view field = NextField(rest); !field.empty(); field = NextField(rest), ++num_columns) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (header.fields[header.xyz[axis]].column != num_columns) continue;
      const std::optional<float> value = ParseFloat(field);
      if (!value.has_value()) return absl::DataLossError(absl::StrCat(Quoted(field), " is not a number"));
      point[static_cast<Eigen::Index>(axis)] = *value;
    }
  }
  if (num_columns == header.point_columns) return absl::OkStatus();
  return absl::DataLossError(absl::StrCat("has ", num_columns, " values, the header says ", header.point_columns));
}

absl::StatusOr<Scan> ParseAscii(const PcdHeader& header, std::string_view data, const CloudReadOptions& options) {
  // Every value takes at least a digit and a separator, but for the last.
  if (header.num_points > (data.size() + 1) / (2 * header.point_columns)) {
    return Truncated(header, absl::StrCat(data.size(), " bytes of text"));
  }
  if (const absl::Status status = CheckMaxPoints(header, options); !status.ok()) return status;
  Scan scan;
  scan.points.reserve(header.num_points);
  LineReader lines(data);
  ReadProgress progress(options, header.num_points);
  while (const std::optional<std::string_view> line = lines.Next()) {
    std::string_view rest = *line;
    if (NextField(rest).empty()) continue;
    if (scan.points.size() == header.num_points) return Truncated(header, "more lines");
    Eigen::Vector3f point;
    if (const absl::Status status = ParseAsciiPoint(header, *line, point); !status.ok()) {
      return absl::DataLossError(
          absl::StrCat("line ", header.header_lines + lines.line_number(), " ", status.message()));
    }
    progress.At(scan.points.size());
    scan.points.push_back(point);
  }
  if (scan.points.size() < header.num_points) return Truncated(header, absl::StrCat(scan.points.size(), " of them"));
  return scan;
}

}  // namespace

bool LooksLikePcd(std::string_view bytes) {
  if (bytes.substr(0, 6) == "# .PCD") return true;
  LineReader lines(bytes.substr(0, 4096));
  while (const std::optional<std::string_view> line = lines.Next()) {
    std::string_view rest = *line;
    const std::string_view key = NextField(rest);
    if (!key.empty() && key[0] != '#') return key == "VERSION" || key == "FIELDS";
  }
  return false;
}

absl::StatusOr<Scan> ParsePcd(std::string_view bytes, const CloudReadOptions& options) {
  const absl::StatusOr<PcdHeader> header = ParsePcdHeader(bytes);
  if (!header.ok()) return header.status();
  const std::string_view data = bytes.substr(header->header_bytes);
  switch (header->data) {
    case PcdData::kAscii:
      return ParseAscii(*header, data, options);
    case PcdData::kBinary:
      return ParseBinary(*header, data, options);
    case PcdData::kBinaryCompressed:
      return ParseCompressed(*header, data, options);
  }
  return absl::InternalError("unknown PCD data");
}

void AppendPcd(const Scan& scan, CloudEncoding encoding, AtomicFile& file) {
  file.Append(absl::StrCat("# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\n",
                           "TYPE F F F\nCOUNT 1 1 1\nWIDTH ", scan.points.size(), "\nHEIGHT 1\n",
                           "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS ", scan.points.size(), "\nDATA ",
                           encoding == CloudEncoding::kAscii ? "ascii" : "binary", "\n"));
  if (encoding == CloudEncoding::kAscii) return AppendTextPoints(scan, ' ', file);
  AppendPackedPoints(scan, file);
}

}  // namespace curvereg
