// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/settings/server_config.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <limits>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "wire/listen_address.h"

namespace curvereg::server {
namespace {

// Size of a request besides the data of its chunk, with a margin.
constexpr uint64_t kMessageOverheadBytes = 4096;
constexpr int kMaxThreads = 4096;
constexpr int kMaxGraceSeconds = 3600;
constexpr int kMaxDrainDelayMs = 600'000;
constexpr int kMaxReloadSeconds = 24 * 3600;

absl::Status Invalid(std::string_view setting, std::string_view text) {
  return absl::InvalidArgumentError(absl::StrCat(std::string(setting), ": ", std::string(text)));
}

template <typename T>
absl::Status CheckRange(const char* setting, T value, uint64_t min, uint64_t max) {
  if (std::cmp_greater_equal(value, min) && std::cmp_less_equal(value, max)) return absl::OkStatus();
  return Invalid(setting, absl::StrCat("must be between ", min, " and ", max, ", is ", value));
}

absl::Status FirstError(std::initializer_list<absl::Status> statuses) {
  const auto error = std::find_if(statuses.begin(), statuses.end(), [](const absl::Status& s) { return !s.ok(); });
  return error == statuses.end() ? absl::OkStatus() : *error;
}

absl::Status CheckLimits(const LimitsConfig& limits) {
  constexpr uint64_t kMaxInt = std::numeric_limits<int>::max();  // gRPC's sizes are ints
  constexpr uint64_t kMaxSize = uint64_t{1} << 62;
  const absl::Status in_range = FirstError({
      CheckRange("limits.max_message_bytes", limits.max_message_bytes, 2 * kMessageOverheadBytes, kMaxInt),
      CheckRange("limits.max_scan_points", limits.max_scan_points, 1, kMaxInt),
      CheckRange("limits.max_scan_bytes", limits.max_scan_bytes, 1, kMaxSize),
      CheckRange("limits.max_chunk_bytes", limits.max_chunk_bytes, 1, kMaxInt),
      CheckRange("limits.max_uploads", limits.max_uploads, 1, kMaxInt),
      CheckRange("limits.upload_lifetime_seconds", limits.upload_lifetime_seconds, 1, uint64_t{1} << 32),
      CheckRange("limits.max_stored_bytes", limits.max_stored_bytes, 1, kMaxSize),
      CheckRange("limits.max_traverses", limits.max_traverses, 1, kMaxInt),
      CheckRange("limits.max_scans_per_traverse", limits.max_scans_per_traverse, 1, kMaxInt),
      CheckRange("limits.max_queue_length", limits.max_queue_length, 1, kMaxInt),
      CheckRange("limits.max_queue_per_client", limits.max_queue_per_client, 1, kMaxInt),
      CheckRange("limits.max_concurrent_registrations", limits.max_concurrent_registrations, 0, kMaxThreads),
      CheckRange("limits.max_threads_per_registration", limits.max_threads_per_registration, 0, kMaxThreads),
      CheckRange("limits.memory_bytes", limits.memory_bytes, 0, kMaxSize),
      CheckRange("limits.cache_bytes", limits.cache_bytes, 0, kMaxSize),
      CheckRange("limits.max_streams_per_connection", limits.max_streams_per_connection, 1, kMaxInt),
  });
  if (!in_range.ok()) return in_range;
  if (limits.max_chunk_bytes + kMessageOverheadBytes > limits.max_message_bytes) {
    return Invalid("limits.max_chunk_bytes",
                   absl::StrCat("must be at least ", kMessageOverheadBytes, " bytes below limits.max_message_bytes (",
                                limits.max_message_bytes, ")"));
  }
  return absl::OkStatus();
}

absl::Status CheckTls(const TlsConfig& tls) {
  if (tls.certificate_file.empty() != tls.key_file.empty()) {
    return Invalid(tls.key_file.empty() ? "tls.key_file" : "tls.certificate_file",
                   "is missing: a certificate needs its key and vice versa");
  }
  if (!tls.client_ca_file.empty() && tls.certificate_file.empty()) {
    return Invalid("tls.client_ca_file", "needs tls.certificate_file and tls.key_file");
  }
  return absl::OkStatus();
}

absl::Status CheckAddresses(const ServerConfig& config) {
  const absl::StatusOr<wire::ListenAddress> listen = wire::ParseListenAddress(config.listen);
  if (!listen.ok()) return Invalid("listen", std::string(listen.status().message()));
  if (!config.ops_listen.empty()) {
    const absl::StatusOr<wire::ListenAddress> ops = wire::ParseListenAddress(config.ops_listen);
    if (!ops.ok()) return Invalid("ops_listen", std::string(ops.status().message()));
  }
  if (!listen->is_loopback && config.tls.certificate_file.empty() && !config.allow_plaintext) {
    return Invalid("listen", absl::StrCat("\"", config.listen,
                                          "\" is not loopback and there is no TLS: set tls.certificate_file and "
                                          "tls.key_file, or allow_plaintext"));
  }
  return absl::OkStatus();
}

absl::Status CheckChoice(std::string_view setting, std::string_view value,
                         std::initializer_list<std::string_view> choices) {
  if (std::find(choices.begin(), choices.end(), value) != choices.end()) return absl::OkStatus();
  std::string text = "must be one of";
  for (const std::string_view choice : choices) absl::StrAppend(&text, " ", std::string(choice));
  return Invalid(setting, absl::StrCat(text, ", is \"", std::string(value), "\""));
}

}  // namespace

absl::Status Validate(const ServerConfig& config) {
  if (config.data_dir.empty()) return Invalid("data_dir", "must not be empty");
  return FirstError({CheckTls(config.tls), CheckAddresses(config), CheckLimits(config.limits),
                     CheckChoice("log.format", config.log.format, {"text", "json"}),
                     CheckChoice("log.level", config.log.level, {"debug", "info", "warning", "error"}),
                     CheckRange("tls.reload_seconds", config.tls.reload_seconds, 1, kMaxReloadSeconds),
                     CheckRange("grace_seconds", config.grace_seconds, 0, kMaxGraceSeconds),
                     CheckRange("drain_delay_ms", config.drain_delay_ms, 0, kMaxDrainDelayMs)});
}

}  // namespace curvereg::server
