// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/settings/settings.h"

#include <array>
#include <cctype>
#include <string>
#include <string_view>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "server/settings/config_sources.h"
#include "server/settings/setting_values.h"

namespace curvereg::server {
namespace {

// The members' addresses, as plain functions that a constant table can hold.
template <auto Member>
auto* At(ServerConfig& config) {
  return &(config.*Member);
}
template <auto Part, auto Member>
auto* Within(ServerConfig& config) {
  return &(config.*Part.*Member);
}

template <auto Member>
constexpr auto kTls = &Within<&ServerConfig::tls, Member>;
template <auto Member>
constexpr auto kLimits = &Within<&ServerConfig::limits, Member>;
template <auto Member>
constexpr auto kLog = &Within<&ServerConfig::log, Member>;

using enum SettingKind;

constexpr std::array kSettings = {
    Setting{"", "listen", kText, &At<&ServerConfig::listen>, "HOST:PORT of the gRPC service; port 0: a free port"},
    Setting{"", "ops_listen", kText, &At<&ServerConfig::ops_listen>,
            "HOST:PORT of /metrics, /livez and /readyz, without TLS; empty: disabled"},
    Setting{"", "data_dir", kText, &At<&ServerConfig::data_dir>, "folder of the store; created if it does not exist"},
    Setting{"", "allow_plaintext", kSwitch, &At<&ServerConfig::allow_plaintext>,
            "allow plain text on addresses other than loopback"},
    Setting{"", "token_file", kText, &At<&ServerConfig::token_file>,
            "TOML file of the tokens that callers must present; empty: no tokens required"},
    Setting{"", "grace_seconds", kCount, &At<&ServerConfig::grace_seconds>,
            "time from SIGTERM to exit [s]; calls still running then are cancelled"},
    Setting{"", "drain_delay_ms", kCount, &At<&ServerConfig::drain_delay_ms>,
            "time from \"not ready\" to refusing calls [ms], for load balancers to react"},
    Setting{"tls", "certificate_file", kText, kTls<&TlsConfig::certificate_file>,
            "PEM certificate chain of the server; empty: plain text"},
    Setting{"tls", "key_file", kText, kTls<&TlsConfig::key_file>, "PEM private key of the certificate"},
    Setting{"tls", "client_ca_file", kText, kTls<&TlsConfig::client_ca_file>,
            "PEM certificate authorities of clients (mutual TLS); empty: no client certificate required"},
    Setting{"tls", "reload_seconds", kCount, kTls<&TlsConfig::reload_seconds>,
            "interval of checking the certificate and token files for changes [s]"},
    Setting{"limits", "max_message_bytes", kBytes, kLimits<&LimitsConfig::max_message_bytes>,
            "maximum size of one request"},
    Setting{"limits", "max_scan_points", kCount, kLimits<&LimitsConfig::max_scan_points>,
            "maximum number of points of one scan"},
    Setting{"limits", "max_scan_bytes", kBytes, kLimits<&LimitsConfig::max_scan_bytes>,
            "maximum payload of one stored scan"},
    Setting{"limits", "max_chunk_bytes", kBytes, kLimits<&LimitsConfig::max_chunk_bytes>,
            "maximum data of one upload chunk"},
    Setting{"limits", "max_uploads", kCount, kLimits<&LimitsConfig::max_uploads>,
            "maximum number of unfinished uploads"},
    Setting{"limits", "upload_lifetime_seconds", kCount, kLimits<&LimitsConfig::upload_lifetime_seconds>,
            "an unfinished upload is deleted this long after its last chunk [s]"},
    Setting{"limits", "max_stored_bytes", kBytes, kLimits<&LimitsConfig::max_stored_bytes>,
            "maximum size of the store"},
    Setting{"limits", "max_traverses", kCount, kLimits<&LimitsConfig::max_traverses>, "maximum number of traverses"},
    Setting{"limits", "max_scans_per_traverse", kCount, kLimits<&LimitsConfig::max_scans_per_traverse>,
            "maximum number of scans of one traverse"},
    Setting{"limits", "max_queue_length", kCount, kLimits<&LimitsConfig::max_queue_length>,
            "maximum number of queued registrations of all clients"},
    Setting{"limits", "max_queue_per_client", kCount, kLimits<&LimitsConfig::max_queue_per_client>,
            "maximum number of queued registrations of one client"},
    Setting{"limits", "max_concurrent_registrations", kCount, kLimits<&LimitsConfig::max_concurrent_registrations>,
            "maximum number of concurrent registrations; 0: one per processor"},
    Setting{"limits", "max_threads_per_registration", kCount, kLimits<&LimitsConfig::max_threads_per_registration>,
            "maximum number of threads of one registration; 0: one per processor"},
    Setting{"limits", "memory_bytes", kBytes, kLimits<&LimitsConfig::memory_bytes>,
            "memory budget of accepted work; 0: half of the memory of the machine or container"},
    Setting{"limits", "cache_bytes", kBytes, kLimits<&LimitsConfig::cache_bytes>,
            "memory of the cache of preprocessed scans; 0: a quarter of memory_bytes"},
    Setting{"limits", "max_streams_per_connection", kCount, kLimits<&LimitsConfig::max_streams_per_connection>,
            "maximum number of concurrent calls on one connection"},
    Setting{"log", "format", kText, kLog<&LogConfig::format>, "text or json"},
    Setting{"log", "level", kText, kLog<&LogConfig::level>, "debug, info, warning or error"},
};

std::string JoinedName(const Setting& setting, char separator) {
  if (*setting.section == '\0') return setting.key;
  return absl::StrCat(setting.section, std::string(1, separator), setting.key);
}

}  // namespace

std::span<const Setting> AllSettings() { return kSettings; }

std::string FlagName(const Setting& setting) {
  return absl::StrCat("--", absl::StrReplaceAll(JoinedName(setting, '-'), {{"_", "-"}}));
}

std::string EnvironmentName(const Setting& setting) {
  return absl::StrCat(kEnvironmentPrefix, absl::AsciiStrToUpper(JoinedName(setting, '_')));
}

std::string TomlName(const Setting& setting) { return JoinedName(setting, '.'); }

std::string ConfigToml(const ServerConfig& config) {
  std::string text;
  std::string_view section;
  for (const Setting& setting : AllSettings()) {
    if (setting.section != section) {
      section = setting.section;
      absl::StrAppend(&text, "\n[", setting.section, "]\n");
    }
    absl::StrAppend(&text, setting.key, " = ", TomlValue(setting, config), "  # ", setting.help, "\n");
  }
  return text;
}

std::string SettingsMarkdown() {
  std::string text = absl::StrCat(
      "# Settings of curvereg-server\n\n"
      "<!-- Generated by `curvereg-server --print-settings`; do not edit. -->\n\n"
      "Flags override environment variables, which override the TOML file (`--config FILE` or `",
      kConfigVariable,
      "`), which overrides the defaults. A name that is not in this table is an error: an unknown key ",
      "of the file, an unknown flag, and an unknown variable that begins with `", kEnvironmentPrefix,
      "` (except those that Kubernetes sets for a Service of that name, such as `", kEnvironmentPrefix,
      "PORT=tcp://10.0.0.1:50051`). `--name=` gives an empty value, which only some settings accept. Sizes may be "
      "written as `512MiB` (B, kB, MB, "
      "GB, TB, KiB, MiB, GiB, TiB). `curvereg-server --print-config` prints the settings in force as a TOML file.\n\n"
      "| TOML key | flag | environment | default | meaning |\n"
      "|---|---|---|---|---|\n");
  const ServerConfig defaults;
  for (const Setting& setting : AllSettings()) {
    absl::StrAppend(&text, "| `", TomlName(setting), "` | `", FlagName(setting), "` | `", EnvironmentName(setting),
                    "` | `", TomlValue(setting, defaults), "` | ", setting.help, " |\n");
  }
  return text;
}

}  // namespace curvereg::server
