// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Lines, fields and numbers of text files, without the locale and without copies.
#ifndef CURVEREG_FILES_TEXT_FIELDS_H_
#define CURVEREG_FILES_TEXT_FIELDS_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace curvereg {

// Goes through the lines of `text`, which must outlive it. Lines end in "\n" or "\r\n"; the last may lack it.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : text_(text) {}

  // The next line without its end; nullopt after the last.
  std::optional<std::string_view> Next();

  int64_t line_number() const { return line_number_; }  // of the line that Next() gave, from 1
  std::size_t offset() const { return offset_; }        // bytes taken so far

 private:
  std::string_view text_;
  std::size_t offset_ = 0;
  int64_t line_number_ = 0;
};

// Takes the next field, separated by spaces and tabs, off the front of `rest`; empty when none is left.
std::string_view NextField(std::string_view& rest);

// The whole field as a number: nearest value, a leading '+' allowed, "nan" and "inf" in any case; beyond the range of
// the type it becomes infinite or zero. Nullopt when the field is anything else.
std::optional<float> ParseFloat(std::string_view field);
std::optional<double> ParseDouble(std::string_view field);

// The whole field as a decimal integer >= 0; nullopt when it is anything else or does not fit.
std::optional<int64_t> ParseCount(std::string_view field);

// Appends the shortest text that reads back as the same number ("nan" for every NaN).
void AppendFloat(float value, std::string& text);

// The field in quotes for a message: cut to 40 bytes, with what cannot be printed replaced by '?'.
std::string Quoted(std::string_view field);

}  // namespace curvereg

#endif  // CURVEREG_FILES_TEXT_FIELDS_H_
