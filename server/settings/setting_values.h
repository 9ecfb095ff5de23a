// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The value of one setting: from text and to text.
#ifndef CURVEREG_SERVER_SETTINGS_SETTING_VALUES_H_
#define CURVEREG_SERVER_SETTINGS_SETTING_VALUES_H_

#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "server/settings/server_config.h"
#include "server/settings/settings.h"

namespace curvereg::server {

// Reads `text` as the setting's kind. INVALID_ARGUMENT tells what is expected, and leaves `config` as it was.
absl::Status SetFromText(const Setting& setting, std::string_view text, ServerConfig& config);

// The value as TOML: "a string", true, 42.
std::string TomlValue(const Setting& setting, const ServerConfig& config);

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_SETTINGS_SETTING_VALUES_H_
