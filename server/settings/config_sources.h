// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Where settings come from: flags > environment > TOML file > defaults. Names nobody knows and values that do not fit
// are INVALID_ARGUMENT with the source: the flag, the variable, or file and line.
#ifndef CURVEREG_SERVER_SETTINGS_CONFIG_SOURCES_H_
#define CURVEREG_SERVER_SETTINGS_CONFIG_SOURCES_H_

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/settings/server_config.h"

namespace curvereg::server {

// The server's variables begin with it. The client's (CURVEREG_SERVER, CURVEREG_TOKEN, CURVEREG_TLS_...) do not.
inline constexpr char kEnvironmentPrefix[] = "CURVEREG_SERVER_";
// Names the TOML file, as --config does.
inline constexpr char kConfigVariable[] = "CURVEREG_SERVER_CONFIG";

using Environment = std::map<std::string, std::string>;
// The server's variables in `environment` ("NAME=VALUE", ends with a null pointer; pass `environ`). Left out are those
// that Kubernetes makes for a Service called curvereg-server..., such as CURVEREG_SERVER_PORT=tcp://10.0.0.1:50051.
Environment ServerEnvironment(const char* const* environment);

absl::Status ApplyToml(std::string_view text, const std::string& file_name, ServerConfig& config);
absl::Status ApplyEnvironment(const Environment& environment, ServerConfig& config);

struct FlagValue {
  std::string name;  // "--data-dir"
  std::string text;
};
absl::Status ApplyFlags(const std::vector<FlagValue>& flags, ServerConfig& config);

struct ConfigSources {
  std::string toml_file{};  // empty: as kConfigVariable says; that empty too: none
  Environment environment{};
  std::vector<FlagValue> flags{};
};

// All sources in order, then Validate. Also the errors of reading the file, with its name and who gave it.
absl::StatusOr<ServerConfig> ReadConfig(const ConfigSources& sources);

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_SETTINGS_CONFIG_SOURCES_H_
