// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The one table of settings: flags, environment names, TOML keys, help, --print-config and docs/settings.md all come
// from it.
#ifndef CURVEREG_SERVER_SETTINGS_SETTINGS_H_
#define CURVEREG_SERVER_SETTINGS_SETTINGS_H_

#include <cstdint>
#include <span>
#include <string>
#include <variant>

#include "server/settings/server_config.h"

namespace curvereg::server {

enum class SettingKind {
  kText,
  kSwitch,  // true, false
  kCount,   // a whole number
  kBytes,   // a whole number, alone or with B, kB, MB, GB, TB, KiB, MiB, GiB, TiB
};

struct Setting {
  using Field = std::variant<std::string* (*)(ServerConfig&), bool* (*)(ServerConfig&), int* (*)(ServerConfig&),
                             int64_t* (*)(ServerConfig&), uint32_t* (*)(ServerConfig&), uint64_t* (*)(ServerConfig&)>;
  const char* section;  // TOML table; empty: top level
  const char* key;      // TOML key, snake_case
  SettingKind kind;
  Field field;
  const char* help;  // one line with the unit and what zero or empty means
};

// In the order in which they are shown; a section's settings stand together, those without a section first.
std::span<const Setting> AllSettings();

std::string FlagName(const Setting& setting);         // "--limits-max-scan-points"
std::string EnvironmentName(const Setting& setting);  // "CURVEREG_SERVER_LIMITS_MAX_SCAN_POINTS"
std::string TomlName(const Setting& setting);         // "limits.max_scan_points"

// All settings as a TOML file with the help as comments; reading it gives the same settings.
std::string ConfigToml(const ServerConfig& config);

// docs/settings.md.
std::string SettingsMarkdown();

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_SETTINGS_SETTINGS_H_
