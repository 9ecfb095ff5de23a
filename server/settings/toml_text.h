// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// TOML without exceptions, for files of settings and of tokens. Only included by .cc files: it is a large header.
#ifndef CURVEREG_SERVER_SETTINGS_TOML_TEXT_H_
#define CURVEREG_SERVER_SETTINGS_TOML_TEXT_H_

#include <toml++/toml.h>

#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace curvereg::server {

// INVALID_ARGUMENT: "FILE:LINE: what is wrong".
absl::StatusOr<toml::table> ParseToml(std::string_view text, const std::string& file_name);

// INVALID_ARGUMENT: "FILE:LINE: text", with the line where the node begins.
absl::Status TomlError(const std::string& file_name, const toml::source_region& source, std::string_view text);

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_SETTINGS_TOML_TEXT_H_
