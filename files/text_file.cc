// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/text_file.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "files/point_output.h"
#include "files/read_progress.h"
#include "files/text_fields.h"

namespace curvereg {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::string_view StripBlanks(std::string_view text) {
  while (!text.empty() && IsBlank(text.front())) text.remove_prefix(1);
  while (!text.empty() && IsBlank(text.back())) text.remove_suffix(1);
  return text;
}

// Takes the next column off the front of `rest`: up to a comma or semicolon with any blanks around it, or up to blanks.
// May be empty between two commas. Nullopt when the line has ended.
std::optional<std::string_view> NextColumn(std::string_view& rest) {
  while (!rest.empty() && IsBlank(rest.front())) rest.remove_prefix(1);
  if (rest.empty()) return std::nullopt;
  std::size_t end = 0;
  while (end < rest.size() && !IsBlank(rest[end]) && rest[end] != ',' && rest[end] != ';') ++end;
  const std::string_view column = rest.substr(0, end);
  rest.remove_prefix(end);
  while (!rest.empty() && IsBlank(rest.front())) rest.remove_prefix(1);
  if (!rest.empty() && (rest.front() == ',' || rest.front() == ';')) rest.remove_prefix(1);
  return column;
}

// Which columns are x, y, z.
struct Columns {
  std::array<std::size_t, 3> xyz = {0, 1, 2};
  bool is_guessed = false;  // there is a header, but it does not name them
};

// From a header line: by name where it has x, y and z, in any case and in quotes or not; else the first three.
Columns ColumnsFromHeader(std::string_view line) {
  std::array<std::optional<std::size_t>, 3> found;
  std::size_t index = 0;
  while (const std::optional<std::string_view> column = NextColumn(line)) {
    std::string_view name = *column;
    if (name.size() > 2 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
    const std::size_t axis =
        name.size() == 1 ? std::string_view("xyz").find(absl::ascii_tolower(static_cast<unsigned char>(name[0])))
                         : std::string_view::npos;
    if (axis < 3 && !found[axis].has_value()) found[axis] = index;
    ++index;
  }
  if (!found[0].has_value() || !found[1].has_value() || !found[2].has_value()) return {{0, 1, 2}, true};
  return {{*found[0], *found[1], *found[2]}, false};
}

// NaN for an empty column; nullopt when it is something else than a number.
std::optional<float> ParseColumn(std::string_view column) {
  return column.empty() ? std::numeric_limits<float>::quiet_NaN() : ParseFloat(column);
}

absl::Status ParseLine(std::string_view line, const Columns& columns, Eigen::Vector3f& point) {
  const std::size_t num_needed = *std::max_element(columns.xyz.begin(), columns.xyz.end()) + 1;
  for (std::size_t index = 0; index < num_needed; ++index) {
    const std::optional<std::string_view> column = NextColumn(line);
    if (!column.has_value()) {
      return absl::InvalidArgumentError(absl::StrCat("has ", index, " columns, needs ", num_needed));
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (columns.xyz[axis] != index) continue;
      const std::optional<float> value = ParseColumn(*column);
      if (!value.has_value()) return absl::InvalidArgumentError(absl::StrCat(Quoted(*column), " is not a number"));
      point[static_cast<Eigen::Index>(axis)] = *value;
    }
  }
  return absl::OkStatus();
}

bool IsComment(std::string_view line) { return line.empty() || line[0] == '#' || line.starts_with("//"); }

// The first line that is no comment: a header when its first column is no number, a count when it is its only column.
// Sets `columns`; true when the line is used up.
absl::StatusOr<bool> TakeFirstLine(std::string_view line, Columns& columns) {
  std::string_view rest = line;
  const std::string_view first = NextColumn(rest).value_or("");
  if (!ParseColumn(first).has_value()) {
    columns = ColumnsFromHeader(line);
    return true;
  }
  if (rest.empty() && ParseCount(first).has_value()) return true;
  if (line.find(';') != line.npos && line.find(',') != line.npos) {
    return absl::InvalidArgumentError("has commas and semicolons; decimal commas are not supported");
  }
  return false;
}

}  // namespace

bool LooksLikeText(std::string_view bytes, bool only_ascii) {
  return std::all_of(bytes.begin(), bytes.begin() + std::min<std::ptrdiff_t>(4096, std::ssize(bytes)), [&](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte >= ' ' && byte < 127) || (byte >= '\t' && byte <= '\r') || (byte > 127 && !only_ascii);
  });
}

absl::StatusOr<Scan> ParseTextCloud(std::string_view bytes, const CloudReadOptions& options) {
  if (bytes.starts_with(kByteOrderMark)) bytes.remove_prefix(kByteOrderMark.size());
  Scan scan;
  Columns columns;
  bool is_first = true;
  LineReader lines(bytes);
  ReadProgress progress(options, bytes.size());
  while (std::optional<std::string_view> line = lines.Next()) {
    *line = StripBlanks(*line);
    if (IsComment(*line)) continue;
    Eigen::Vector3f point;
    absl::StatusOr<bool> is_taken = false;
    if (is_first) is_taken = TakeFirstLine(*line, columns);
    is_first = false;
    if (is_taken.ok() && *is_taken) continue;
    const absl::Status status = is_taken.ok() ? ParseLine(*line, columns, point) : is_taken.status();
    if (!status.ok()) {
      return absl::InvalidArgumentError(absl::StrCat("line ", lines.line_number(), ": ", status.message()));
    }
    if (std::ssize(scan.points) >= options.max_points) {
      return absl::ResourceExhaustedError(absl::StrCat("contains more points than the limit of ", options.max_points));
    }
    scan.points.push_back(point);
    progress.At(lines.offset());
  }
  if (scan.points.empty() && columns.is_guessed) return absl::InvalidArgumentError("contains no line of coordinates");
  return scan;
}

void AppendTextCloud(const Scan& scan, bool is_csv, AtomicFile& file) {
  file.Append(is_csv ? "x,y,z\n" : "# x y z\n");
  AppendTextPoints(scan, is_csv ? ',' : ' ', file);
}

}  // namespace curvereg
