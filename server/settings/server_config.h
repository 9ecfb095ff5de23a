// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Everything that can be set about a server. Flags > environment (CURVEREG_...) > TOML file > the defaults here.
#ifndef CURVEREG_SERVER_SETTINGS_SERVER_CONFIG_H_
#define CURVEREG_SERVER_SETTINGS_SERVER_CONFIG_H_

#include <cstdint>
#include <string>

#include "absl/status/status.h"

namespace curvereg::server {

struct TlsConfig {
  std::string certificate_file;  // PEM chain of the server; empty: plain text
  std::string key_file;          // PEM private key
  std::string client_ca_file;    // PEM; given: clients must show a certificate that it signed (mutual TLS)
  int reload_seconds = 10;       // files are looked at for changes this often
};

struct LimitsConfig {
  uint64_t max_message_bytes = uint64_t{32} << 20;  // of one request; holds two inline scans of a million points
  uint64_t max_scan_points = 10'000'000;
  uint64_t max_scan_bytes = uint64_t{256} << 20;  // payload of one stored scan
  uint32_t max_chunk_bytes = 1U << 20;            // data of one upload chunk
  int max_uploads = 1024;                         // unfinished ones
  int64_t upload_lifetime_seconds = 7 * 24 * 3600;
  uint64_t max_stored_bytes = uint64_t{50} << 30;
  int max_traverses = 1000;
  int max_scans_per_traverse = 10'000;
  int max_queue_length = 64;
  int max_queue_per_client = 16;
  int max_concurrent_registrations = 0;  // 0: one per processor
  int max_threads_per_registration = 0;  // 0: one per processor
  uint64_t memory_bytes = 0;             // reserved for accepted work; 0: half of what the machine or container has
  uint64_t cache_bytes = 0;              // prepared scans; 0: a quarter of that
  int max_streams_per_connection = 256;
};

struct LogConfig {
  std::string format = "text";  // text, json
  std::string level = "info";   // debug, info, warning, error
};

struct ServerConfig {
  std::string listen = "127.0.0.1:50051";     // HOST:PORT of gRPC; port 0 takes a free one
  std::string ops_listen = "127.0.0.1:9464";  // HOST:PORT of /metrics, /livez, /readyz; empty: none
  std::string data_dir = "curvereg-data";
  bool allow_plaintext = false;  // off loopback
  TlsConfig tls;
  std::string token_file;  // TOML; empty: no tokens asked for
  LimitsConfig limits;
  LogConfig log;
  int grace_seconds = 25;    // from SIGTERM to exit
  int drain_delay_ms = 500;  // from "not ready" to refusing connections: lets load balancers notice
};

// INVALID_ARGUMENT naming the setting: out of range, or plain text off loopback without allow_plaintext.
absl::Status Validate(const ServerConfig& config);

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_SETTINGS_SERVER_CONFIG_H_
