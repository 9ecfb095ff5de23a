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
    Setting{"", "listen", kText, &At<&ServerConfig::listen>, "HOST:PORT of gRPC; port 0 takes a free one"},
    Setting{"", "ops_listen", kText, &At<&ServerConfig::ops_listen>,
            "HOST:PORT of /metrics, /livez and /readyz, without TLS; empty: none"},
    Setting{"", "data_dir", kText, &At<&ServerConfig::data_dir>, "folder of the store; made when it is not there"},
    Setting{"", "allow_plaintext", kSwitch, &At<&ServerConfig::allow_plaintext>,
            "listen without TLS on an address that is not loopback"},
    Setting{"", "token_file", kText, &At<&ServerConfig::token_file>,
            "TOML file of the tokens that callers must show; empty: none asked for"},
    Setting{"", "grace_seconds", kCount, &At<&ServerConfig::grace_seconds>,
            "from SIGTERM to exit [s]; what still runs then is cancelled"},
    Setting{"", "drain_delay_ms", kCount, &At<&ServerConfig::drain_delay_ms>,
            "from \"not ready\" to refusing calls [ms], for load balancers to notice"},
    Setting{"tls", "certificate_file", kText, kTls<&TlsConfig::certificate_file>,
            "PEM chain of the server; empty: plain text"},
    Setting{"tls", "key_file", kText, kTls<&TlsConfig::key_file>, "PEM private key of the certificate"},
    Setting{"tls", "client_ca_file", kText, kTls<&TlsConfig::client_ca_file>,
            "PEM authorities; clients must then show a certificate that one of them signed"},
    Setting{"tls", "reload_seconds", kCount, kTls<&TlsConfig::reload_seconds>,
            "how often certificate and token files are looked at for changes [s]"},
    Setting{"limits", "max_message_bytes", kBytes, kLimits<&LimitsConfig::max_message_bytes>, "size of one request"},
    Setting{"limits", "max_scan_points", kCount, kLimits<&LimitsConfig::max_scan_points>, "points of one scan"},
    Setting{"limits", "max_scan_bytes", kBytes, kLimits<&LimitsConfig::max_scan_bytes>, "payload of one stored scan"},
    Setting{"limits", "max_chunk_bytes", kBytes, kLimits<&LimitsConfig::max_chunk_bytes>, "data of one upload chunk"},
    Setting{"limits", "max_uploads", kCount, kLimits<&LimitsConfig::max_uploads>, "unfinished uploads"},
    Setting{"limits", "upload_lifetime_seconds", kCount, kLimits<&LimitsConfig::upload_lifetime_seconds>,
            "an unfinished upload is forgotten this long after its last chunk [s]"},
    Setting{"limits", "max_stored_bytes", kBytes, kLimits<&LimitsConfig::max_stored_bytes>, "all that the store holds"},
    Setting{"limits", "max_traverses", kCount, kLimits<&LimitsConfig::max_traverses>, "traverses that are kept"},
    Setting{"limits", "max_scans_per_traverse", kCount, kLimits<&LimitsConfig::max_scans_per_traverse>,
            "scans of one traverse"},
    Setting{"limits", "max_queue_length", kCount, kLimits<&LimitsConfig::max_queue_length>,
            "registrations that wait, of all clients"},
    Setting{"limits", "max_queue_per_client", kCount, kLimits<&LimitsConfig::max_queue_per_client>,
            "registrations that wait, of one client"},
    Setting{"limits", "max_concurrent_registrations", kCount, kLimits<&LimitsConfig::max_concurrent_registrations>,
            "registrations that run; 0: one per processor"},
    Setting{"limits", "max_threads_per_registration", kCount, kLimits<&LimitsConfig::max_threads_per_registration>,
            "threads of one registration; 0: one per processor"},
    Setting{"limits", "memory_bytes", kBytes, kLimits<&LimitsConfig::memory_bytes>,
            "memory for accepted work; 0: half of what the machine or container has"},
    Setting{"limits", "cache_bytes", kBytes, kLimits<&LimitsConfig::cache_bytes>,
            "memory for prepared scans; 0: a quarter of memory_bytes"},
    Setting{"limits", "max_streams_per_connection", kCount, kLimits<&LimitsConfig::max_streams_per_connection>,
            "calls at once on one connection"},
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
      "<!-- Made by `curvereg-server --print-settings`; do not edit. -->\n\n"
      "Flags go before environment variables, these before the TOML file (`--config FILE` or `",
      kConfigVariable,
      "`), and that before the defaults. A name that is not in this table is an error: an unknown key ",
      "of the file, an unknown flag, and an unknown variable that begins with `", kEnvironmentPrefix,
      "` (but for those that Kubernetes makes for a Service of such a name, as `", kEnvironmentPrefix,
      "PORT=tcp://10.0.0.1:50051`). `--name=` gives an empty value, which only some settings take. Sizes may be "
      "written `512MiB` (B, kB, MB, "
      "GB, TB, KiB, MiB, GiB, TiB). `curvereg-server --print-config` prints what is in force, as a TOML file.\n\n"
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
