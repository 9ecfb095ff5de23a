// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/settings/server_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "wire/listen_address.h"

namespace curvereg::server {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(ServerConfigTest, TheDefaultsAreValid) { EXPECT_TRUE(Validate(ServerConfig()).ok()); }

struct BadSetting {
  const char* name;
  std::function<void(ServerConfig&)> spoil;
};

TEST(ServerConfigTest, EachBadSettingIsNamed) {
  const std::vector<BadSetting> cases = {
      {"listen", [](ServerConfig& c) { c.listen = "50051"; }},
      {"listen", [](ServerConfig& c) { c.listen = "127.0.0.1:65536"; }},
      {"listen", [](ServerConfig& c) { c.listen = "0.0.0.0:50051"; }},
      {"listen", [](ServerConfig& c) { c.listen = "[::]:50051"; }},
      {"listen", [](ServerConfig& c) { c.listen = "example.org:50051"; }},
      {"ops_listen", [](ServerConfig& c) { c.ops_listen = ":9464"; }},
      {"data_dir", [](ServerConfig& c) { c.data_dir = ""; }},
      {"tls.key_file", [](ServerConfig& c) { c.tls.certificate_file = "c.pem"; }},
      {"tls.certificate_file", [](ServerConfig& c) { c.tls.key_file = "k.pem"; }},
      {"tls.client_ca_file", [](ServerConfig& c) { c.tls.client_ca_file = "ca.pem"; }},
      {"tls.reload_seconds", [](ServerConfig& c) { c.tls.reload_seconds = 0; }},
      {"limits.max_message_bytes", [](ServerConfig& c) { c.limits.max_message_bytes = uint64_t{1} << 31; }},
      {"limits.max_scan_points", [](ServerConfig& c) { c.limits.max_scan_points = 0; }},
      {"limits.max_chunk_bytes", [](ServerConfig& c) { c.limits.max_chunk_bytes = 32U << 20; }},
      {"limits.max_uploads", [](ServerConfig& c) { c.limits.max_uploads = -1; }},
      {"limits.max_queue_length", [](ServerConfig& c) { c.limits.max_queue_length = 0; }},
      {"limits.max_concurrent_registrations", [](ServerConfig& c) { c.limits.max_concurrent_registrations = -1; }},
      {"log.format", [](ServerConfig& c) { c.log.format = "xml"; }},
      {"log.level", [](ServerConfig& c) { c.log.level = "loud"; }},
      {"grace_seconds", [](ServerConfig& c) { c.grace_seconds = -1; }},
      {"drain_delay_ms", [](ServerConfig& c) { c.drain_delay_ms = -1; }},
  };
  for (const BadSetting& bad : cases) {
    ServerConfig config;
    bad.spoil(config);
    const absl::Status status = Validate(config);
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << bad.name;
    EXPECT_THAT(std::string(status.message()), StartsWith(std::string(bad.name) + ": "));
  }
}

TEST(ServerConfigTest, AValueOutOfRangeIsShownAsItIs) {
  ServerConfig config;
  config.limits.max_stored_bytes = ~uint64_t{0};
  EXPECT_THAT(std::string(Validate(config).message()), HasSubstr("is 18446744073709551615"));
  config = ServerConfig();
  config.limits.max_uploads = -7;
  EXPECT_THAT(std::string(Validate(config).message()), HasSubstr("is -7"));
}

TEST(ServerConfigTest, PlainTextOffLoopbackMustBeAskedForOrSecured) {
  ServerConfig config;
  config.listen = "0.0.0.0:0";
  EXPECT_THAT(std::string(Validate(config).message()), HasSubstr("allow_plaintext"));
  ServerConfig told = config;
  told.allow_plaintext = true;
  EXPECT_TRUE(Validate(told).ok());
  ServerConfig secured = config;
  secured.tls.certificate_file = "c.pem";
  secured.tls.key_file = "k.pem";
  EXPECT_TRUE(Validate(secured).ok());
}

TEST(ListenAddressTest, KnowsLoopback) {
  for (const char* text : {"127.0.0.1:1", "127.9.9.9:1", "[::1]:1", "localhost:1"}) {
    EXPECT_TRUE(wire::ParseListenAddress(text)->is_loopback) << text;
  }
  for (const char* text : {"0.0.0.0:1", "128.0.0.1:1", "[::]:1", "[::ffff:127.0.0.1]:1", "localhost.example:1"}) {
    EXPECT_FALSE(wire::ParseListenAddress(text)->is_loopback) << text;
  }
}

TEST(ListenAddressTest, SplitsHostAndPort) {
  EXPECT_EQ(wire::ParseListenAddress("[fe80::1]:50051")->host, "fe80::1");
  EXPECT_EQ(wire::ParseListenAddress("[fe80::1]:50051")->port, 50051);
  EXPECT_EQ(wire::ParseListenAddress("host:0")->port, 0);
  for (const char* text : {"", ":", "host", "host:", "host:-1", "host:1x", "host:65536", "::1:50051", "[]:1", ":1"}) {
    EXPECT_FALSE(wire::ParseListenAddress(text).ok()) << text;
  }
}

}  // namespace
}  // namespace curvereg::server
