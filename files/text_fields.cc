// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/text_fields.h"

#include <charconv>
#include <cmath>
#include <limits>

namespace curvereg {
namespace {

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

template <typename T>
std::optional<T> ParseReal(std::string_view field) {
  // from_chars takes no '+'.
  if (field.size() > 1 && field[0] == '+' && field[1] != '-' && field[1] != '+') field.remove_prefix(1);
  T value{};
  const char* end = field.data() + field.size();
  const std::from_chars_result result = std::from_chars(field.data(), end, value);
  if (result.ptr != end || field.empty()) return std::nullopt;
  if (result.ec == std::errc()) return value;
  if (result.ec != std::errc::result_out_of_range) return std::nullopt;
  const bool is_tiny = field.find("e-") != field.npos || field.find("E-") != field.npos || field.substr(0, 1) == "0" ||
                       field.substr(0, 2) == "-0";
  const T magnitude = is_tiny ? T{0} : std::numeric_limits<T>::infinity();
  return field[0] == '-' ? -magnitude : magnitude;
}

}  // namespace

std::optional<std::string_view> LineReader::Next() {
  if (offset_ >= text_.size()) return std::nullopt;
  const std::size_t end = text_.find('\n', offset_);
  std::string_view line = text_.substr(offset_, end == text_.npos ? text_.npos : end - offset_);
  offset_ = end == text_.npos ? text_.size() : end + 1;
  ++line_number_;
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

std::string_view NextField(std::string_view& rest) {
  std::size_t begin = 0;
  while (begin < rest.size() && IsBlank(rest[begin])) ++begin;
  std::size_t end = begin;
  while (end < rest.size() && !IsBlank(rest[end])) ++end;
  const std::string_view field = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return field;
}

std::optional<float> ParseFloat(std::string_view field) { return ParseReal<float>(field); }

std::optional<double> ParseDouble(std::string_view field) { return ParseReal<double>(field); }

std::optional<int64_t> ParseCount(std::string_view field) {
  int64_t value = 0;
  const char* end = field.data() + field.size();
  const std::from_chars_result result = std::from_chars(field.data(), end, value);
  if (field.empty() || result.ptr != end || result.ec != std::errc() || value < 0) return std::nullopt;
  return value;
}

void AppendFloat(float value, std::string& text) {
  if (std::isnan(value)) {
    text += "nan";
    return;
  }
  char digits[32];
  const std::to_chars_result result = std::to_chars(digits, digits + sizeof(digits), value);
  text.append(digits, result.ptr);
}

std::string Quoted(std::string_view field) {
  constexpr std::size_t kMaxBytes = 40;
  std::string text = "'";
  for (const char c : field.substr(0, kMaxBytes)) text += c >= ' ' && c <= '~' ? c : '?';
  text += field.size() > kMaxBytes ? "...'" : "'";
  return text;
}

}  // namespace curvereg
