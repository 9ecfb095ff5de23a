// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/settings/config_sources.h"

#include <algorithm>
#include <array>
#include <optional>

#include "absl/strings/str_cat.h"
#include "server/settings/setting_values.h"
#include "server/settings/settings.h"
#include "server/settings/small_file.h"
#include "server/settings/toml_text.h"

namespace curvereg::server {
namespace {

constexpr std::string_view kDigits = "0123456789";
constexpr std::string_view kAddressLetters = "0123456789abcdefABCDEF.:";
constexpr std::string_view kServicePort = "_SERVICE_PORT";
constexpr std::string_view kPort = "_PORT_";

absl::Status Named(std::string_view source, const absl::Status& status) {
  if (status.ok()) return status;
  return absl::Status(status.code(), absl::StrCat(std::string(source), ": ", std::string(status.message())));
}

template <typename NameOf>
const Setting* FindSetting(std::string_view name, NameOf name_of) {
  const auto settings = AllSettings();
  const auto found =
      std::find_if(settings.begin(), settings.end(), [&](const Setting& s) { return name_of(s) == name; });
  return found == settings.end() ? nullptr : &*found;
}

bool Holds(std::string_view text, std::string_view letters) {
  return !text.empty() && text.find_first_not_of(letters) == std::string_view::npos;
}

// "50051_TCP", "50051_TCP_ADDR"...: what Kubernetes sets for one port.
bool IsPortDetail(std::string_view text) {
  const std::size_t end = text.find_first_not_of(kDigits);
  if (end == 0 || end == std::string_view::npos) return false;
  constexpr std::array<std::string_view, 3> kProtocols = {"_TCP", "_UDP", "_SCTP"};
  return std::any_of(kProtocols.begin(), kProtocols.end(), [rest = text.substr(end)](std::string_view protocol) {
    if (!rest.starts_with(protocol)) return false;
    const std::string_view detail = rest.substr(protocol.size());
    return detail.empty() || detail == "_PROTO" || detail == "_PORT" || detail == "_ADDR";
  });
}

// Kubernetes sets variables for every Service of the namespace in each container: a Service "curvereg-server" becomes
// CURVEREG_SERVER_SERVICE_HOST, _SERVICE_PORT, _SERVICE_PORT_GRPC, _PORT=tcp://10.0.0.1:50051, _PORT_50051_TCP,
// _PORT_50051_TCP_ADDR... The values are looked at too, for CURVEREG_SERVER_PORT=50051 is somebody's mistake.
bool IsFromKubernetes(std::string_view name, std::string_view value) {
  const std::string_view rest = name.substr(sizeof(kEnvironmentPrefix) - 2);  // with the prefix's last '_'
  if (rest.ends_with("_SERVICE_HOST")) return Holds(value, kAddressLetters);
  const std::size_t service_port = rest.find(kServicePort);
  if (service_port != std::string_view::npos) {
    const std::string_view port_name = rest.substr(service_port + kServicePort.size());
    return (port_name.empty() || port_name.front() == '_') && Holds(value, kDigits);
  }
  const bool is_endpoint = value.starts_with("tcp://") || value.starts_with("udp://") || value.starts_with("sctp://");
  if (rest.ends_with("_PORT") && is_endpoint) return true;
  const std::size_t port = rest.find(kPort);
  return port != std::string_view::npos && IsPortDetail(rest.substr(port + kPort.size()));
}

bool IsSection(std::string_view name) {
  const auto settings = AllSettings();
  return !name.empty() && std::any_of(settings.begin(), settings.end(),
                                      [name](const Setting& setting) { return setting.section == name; });
}

// The value as text, when it is of a type that the setting may be written as.
std::optional<std::string> TextOf(const toml::node& node, SettingKind kind) {
  const bool is_number = kind == SettingKind::kCount || kind == SettingKind::kBytes;
  if (const auto* number = node.as_integer())
    return is_number ? std::optional(absl::StrCat(number->get())) : std::nullopt;
  if (const auto* flag = node.as_boolean()) {
    return kind == SettingKind::kSwitch ? std::optional<std::string>(flag->get() ? "true" : "false") : std::nullopt;
  }
  const auto* text = node.as_string();
  const bool is_text = kind == SettingKind::kText || kind == SettingKind::kBytes;
  return text != nullptr && is_text ? std::optional(text->get()) : std::nullopt;
}

const char* TypeText(SettingKind kind) {
  switch (kind) {
    case SettingKind::kText:
      return "a string";
    case SettingKind::kSwitch:
      return "true or false";
    case SettingKind::kCount:
      return "a whole number";
    case SettingKind::kBytes:
      return "a whole number or a string such as \"512MiB\"";
  }
  return "";
}

// One table of the file: the top level or a section.
absl::Status ApplyTable(const toml::table& table, const std::string& section, const std::string& file_name,
                        ServerConfig& config) {
  for (const auto& [key, node] : table) {
    const std::string name = section.empty() ? std::string(key.str()) : section + "." + std::string(key.str());
    if (section.empty() && node.is_table() && IsSection(name)) {
      const absl::Status status = ApplyTable(*node.as_table(), name, file_name, config);
      if (!status.ok()) return status;
      continue;
    }
    const Setting* setting = FindSetting(name, TomlName);
    if (setting == nullptr) return TomlError(file_name, key.source(), "unknown setting \"" + name + "\"");
    const std::optional<std::string> text = TextOf(node, setting->kind);
    if (!text.has_value()) return TomlError(file_name, node.source(), name + " must be " + TypeText(setting->kind));
    const absl::Status status = SetFromText(*setting, *text, config);
    if (!status.ok()) return TomlError(file_name, node.source(), name + ": " + std::string(status.message()));
  }
  return absl::OkStatus();
}

}  // namespace

Environment ServerEnvironment(const char* const* environment) {
  Environment ours;
  for (; *environment != nullptr; ++environment) {
    const std::string_view entry = *environment;
    const std::size_t equals = entry.find('=');
    const std::string_view name = entry.substr(0, equals);
    if (equals == std::string_view::npos || !name.starts_with(kEnvironmentPrefix)) continue;
    const std::string_view value = entry.substr(equals + 1);
    if (!IsFromKubernetes(name, value)) ours.emplace(name, value);
  }
  return ours;
}

absl::Status ApplyToml(std::string_view text, const std::string& file_name, ServerConfig& config) {
  const absl::StatusOr<toml::table> table = ParseToml(text, file_name);
  if (!table.ok()) return table.status();
  return ApplyTable(*table, "", file_name, config);
}

absl::Status ApplyEnvironment(const Environment& environment, ServerConfig& config) {
  for (const auto& [name, text] : environment) {
    if (name == kConfigVariable) continue;
    const std::string source = "environment variable " + name;
    const Setting* setting = FindSetting(name, EnvironmentName);
    if (setting == nullptr) return absl::InvalidArgumentError(source + ": unknown setting");
    const absl::Status status = SetFromText(*setting, text, config);
    if (!status.ok()) return Named(source, status);
  }
  return absl::OkStatus();
}

absl::Status ApplyFlags(const std::vector<FlagValue>& flags, ServerConfig& config) {
  for (const FlagValue& flag : flags) {
    const Setting* setting = FindSetting(flag.name, FlagName);
    if (setting == nullptr) return absl::InvalidArgumentError(flag.name + ": unknown setting");
    const absl::Status status = SetFromText(*setting, flag.text, config);
    if (!status.ok()) return Named(flag.name, status);
  }
  return absl::OkStatus();
}

absl::StatusOr<ServerConfig> ReadConfig(const ConfigSources& sources) {
  ServerConfig config;
  const auto variable = sources.environment.find(kConfigVariable);
  const bool by_variable = sources.toml_file.empty() && variable != sources.environment.end();
  const std::string file = by_variable ? variable->second : sources.toml_file;
  if (!file.empty()) {
    const absl::StatusOr<std::string> text = ReadSmallFile(file);
    if (!text.ok()) return Named(by_variable ? kConfigVariable : "--config", text.status());
    const absl::Status status = ApplyToml(*text, file, config);
    if (!status.ok()) return status;
  }
  for (const absl::Status& status :
       {ApplyEnvironment(sources.environment, config), ApplyFlags(sources.flags, config), Validate(config)}) {
    if (!status.ok()) return status;
  }
  return config;
}

}  // namespace curvereg::server
