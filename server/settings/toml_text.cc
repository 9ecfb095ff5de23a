// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/settings/toml_text.h"

#include "absl/strings/str_cat.h"

namespace curvereg::server {
absl::StatusOr<toml::table> ParseToml(std::string_view text, const std::string& file_name) {
  try {  // the library throws; nothing of ours does
    return toml::parse(text, std::string_view(file_name));
  } catch (const toml::parse_error& error) {
    return TomlError(file_name, error.source(), error.description());
  }
}

absl::Status TomlError(const std::string& file_name, const toml::source_region& source, std::string_view text) {
  return absl::InvalidArgumentError(absl::StrCat(file_name, ":", source.begin.line, ": ", std::string(text)));
}

}  // namespace curvereg::server
