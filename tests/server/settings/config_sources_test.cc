// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/settings/config_sources.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "server/settings/setting_values.h"
#include "server/settings/settings.h"
#include "tests/testing/test_data.h"

namespace curvereg::server {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string Message(const absl::Status& status) { return std::string(status.message()); }

std::string TomlFailure(const std::string& text) {
  ServerConfig config;
  const absl::Status status = ApplyToml(text, "server.toml", config);
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << text;
  return Message(status);
}

TEST(ConfigSourcesTest, WithoutSourcesTheDefaultsHold) {
  const absl::StatusOr<ServerConfig> config = ReadConfig({});
  ASSERT_TRUE(config.ok()) << config.status();
  EXPECT_EQ(ConfigToml(*config), ConfigToml(ServerConfig()));
  EXPECT_EQ(config->listen, "127.0.0.1:50051");
}

TEST(ConfigSourcesTest, FlagsGoBeforeTheEnvironmentAndThatBeforeTheFile) {
  const testing::TemporaryFolder folder;
  const std::string file = folder.File("server.toml");
  std::ofstream(file) << "data_dir = 'from-file'\ngrace_seconds = 1\ndrain_delay_ms = 1\n[log]\nlevel = 'debug'\n";
  const absl::StatusOr<ServerConfig> config =
      ReadConfig({.toml_file = file,
                  .environment = {{"CURVEREG_SERVER_GRACE_SECONDS", "2"}, {"CURVEREG_SERVER_DRAIN_DELAY_MS", "2"}},
                  .flags = {{"--drain-delay-ms", "3"}}});
  ASSERT_TRUE(config.ok()) << config.status();
  EXPECT_EQ(config->data_dir, "from-file");
  EXPECT_EQ(config->log.level, "debug");
  EXPECT_EQ(config->grace_seconds, 2);
  EXPECT_EQ(config->drain_delay_ms, 3);
}

TEST(ConfigSourcesTest, TheEnvironmentNamesTheFileUnlessAFlagDoes) {
  const testing::TemporaryFolder folder;
  std::ofstream(folder.File("a.toml")) << "data_dir = 'a'\n";
  std::ofstream(folder.File("b.toml")) << "data_dir = 'b'\n";
  const Environment environment = {{"CURVEREG_SERVER_CONFIG", folder.File("a.toml")}};
  EXPECT_EQ(ReadConfig({.environment = environment})->data_dir, "a");
  EXPECT_EQ(ReadConfig({.toml_file = folder.File("b.toml"), .environment = environment})->data_dir, "b");
}

TEST(ConfigSourcesTest, AFileThatIsNotThereIsNamed) {
  const absl::Status status = ReadConfig({.toml_file = "no/such.toml"}).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(Message(status), StartsWith("--config: no/such.toml: "));
  EXPECT_THAT(Message(ReadConfig({.environment = {{"CURVEREG_SERVER_CONFIG", "no/such.toml"}}}).status()),
              StartsWith("CURVEREG_SERVER_CONFIG: no/such.toml: "));
}

TEST(ConfigSourcesTest, TomlReadsEveryKind) {
  ServerConfig config;
  const absl::Status status = ApplyToml(
      "allow_plaintext = true\nlisten = '[::1]:0'\n[limits]\nmax_scan_bytes = '512MiB'\ncache_bytes = 1_000\n"
      "max_queue_length = 7\nupload_lifetime_seconds = 60\n[tls]\nkey_file = 'k'\n",
      "server.toml", config);
  ASSERT_TRUE(status.ok()) << status;
  EXPECT_TRUE(config.allow_plaintext);
  EXPECT_EQ(config.listen, "[::1]:0");
  EXPECT_EQ(config.limits.max_scan_bytes, uint64_t{512} << 20);
  EXPECT_EQ(config.limits.cache_bytes, 1000u);
  EXPECT_EQ(config.limits.max_queue_length, 7);
  EXPECT_EQ(config.limits.upload_lifetime_seconds, 60);
  EXPECT_EQ(config.tls.key_file, "k");
}

TEST(ConfigSourcesTest, TomlErrorsNameFileAndLine) {
  EXPECT_THAT(TomlFailure("listen = 'a:1'\n\nlisten_port = 1\n"),
              AllOf(StartsWith("server.toml:3: "), HasSubstr("listen_port")));
  EXPECT_THAT(TomlFailure("[limits]\nmax_point = 1\n"),
              AllOf(StartsWith("server.toml:2: "), HasSubstr("limits.max_point")));
  EXPECT_THAT(TomlFailure("[limit]\n"), AllOf(StartsWith("server.toml:1: "), HasSubstr("\"limit\"")));
  EXPECT_THAT(TomlFailure("limits = 3\n"), StartsWith("server.toml:1: "));
  EXPECT_THAT(TomlFailure("[limits.max_uploads]\nx = 3\n"), StartsWith("server.toml:1: "));
  EXPECT_THAT(TomlFailure("\nlisten = 5\n"), AllOf(StartsWith("server.toml:2: "), HasSubstr("a string")));
  EXPECT_THAT(TomlFailure("grace_seconds = '5'\n"), HasSubstr("whole number"));
  EXPECT_THAT(TomlFailure("grace_seconds = 1.5\n"), HasSubstr("whole number"));
  EXPECT_THAT(TomlFailure("grace_seconds = 5000000000\n"), HasSubstr("2147483647"));
  EXPECT_THAT(TomlFailure("allow_plaintext = 1\n"), HasSubstr("true or false"));
  EXPECT_THAT(TomlFailure("[limits]\nmemory_bytes = '5 pounds'\n"), HasSubstr("512MiB"));
  EXPECT_THAT(TomlFailure("[limits]\nmemory_bytes = -1\n"), HasSubstr("limits.memory_bytes"));
  EXPECT_THAT(TomlFailure("data_dir = \"a\\u0000b\"\n"), HasSubstr("data_dir: must not contain a zero byte"));
  EXPECT_THAT(TomlFailure("['']\nlisten = '[::1]:0'\n"), HasSubstr("unknown setting \"\""));
  EXPECT_THAT(TomlFailure("[log]\n\"level\\u0000\" = 'info'\n"), HasSubstr("unknown setting"));
  EXPECT_THAT(TomlFailure("a = 1\nlisten = \n"), StartsWith("server.toml:2: "));
}

TEST(ConfigSourcesTest, UnknownVariablesAreErrorsAndNamed) {
  ServerConfig config;
  EXPECT_THAT(Message(ApplyEnvironment({{"CURVEREG_SERVER_LISTEN_PORT_NUMBER", "1"}}, config)),
              HasSubstr("CURVEREG_SERVER_LISTEN_PORT_NUMBER"));
  EXPECT_THAT(Message(ApplyEnvironment({{"CURVEREG_SERVER_GRACE_SECONDS", "soon"}}, config)),
              AllOf(HasSubstr("CURVEREG_SERVER_GRACE_SECONDS"), HasSubstr("\"soon\"")));
}

TEST(ConfigSourcesTest, TheEnvironmentIsTheServersAlone) {
  const char* const environment[] = {"HOME=/root",
                                     "CURVEREG_SERVER=host:1",
                                     "CURVEREG_TOKEN=t",
                                     "CURVEREG_TLS_CA_FILE=f",
                                     "CURVEREG_SERVER_LISTEN=a=b",
                                     "CURVEREG_SERVER_WRONG=1",
                                     "CURVEREG_SERVER_SERVICE_HOST=10.0.0.1",
                                     "CURVEREG_SERVER_SERVICE_PORT=1",
                                     "CURVEREG_SERVER_SERVICE_PORT_GRPC=1",
                                     "CURVEREG_SERVER_PORT=tcp://10.0.0.1:1",
                                     "CURVEREG_SERVER_PORT_50051_TCP=tcp://10.0.0.1:1",
                                     "CURVEREG_SERVER_PORT_50051_TCP_PROTO=tcp",
                                     "CURVEREG_SERVER_PORT_50051_TCP_PORT=50051",
                                     "CURVEREG_SERVER_PORT_50051_TCP_ADDR=fd00::1",
                                     "CURVEREG_SERVER_OPS_SERVICE_HOST=fd00::1",
                                     "CURVEREG_SERVER_OPS_PORT=udp://[fd00::1]:1",
                                     "CURVEREG_SERVER_OPS_PORT_9464_UDP=udp://10.0.0.1:1",
                                     nullptr};
  EXPECT_EQ(ServerEnvironment(environment),
            (Environment{{"CURVEREG_SERVER_LISTEN", "a=b"}, {"CURVEREG_SERVER_WRONG", "1"}}));
}

TEST(ConfigSourcesTest, WhatOnlyLooksLikeKubernetesIsNotLeftOut) {
  for (const char* variable :
       {"CURVEREG_SERVER_PORT=7777", "CURVEREG_SERVER_PORT=", "CURVEREG_SERVER_LISTEN_PORT=7777",
        "CURVEREG_SERVER_OPS_PORT=127.0.0.1:9464", "CURVEREG_SERVER_SERVICE_HOST=station.example",
        "CURVEREG_SERVER_SERVICE_PORT=tcp", "CURVEREG_SERVER_SERVICE_PORTAL=1", "CURVEREG_SERVER_PORT_50051=1",
        "CURVEREG_SERVER_PORT_50051_TCP_NAME=x", "CURVEREG_SERVER_PORT_TCP=tcp://10.0.0.1:1"}) {
    const char* const environment[] = {variable, nullptr};
    ServerConfig config;
    EXPECT_EQ(ApplyEnvironment(ServerEnvironment(environment), config).code(), absl::StatusCode::kInvalidArgument)
        << variable;
  }
}

TEST(ConfigSourcesTest, UnknownFlagsAndBadValuesAreNamed) {
  ServerConfig config;
  EXPECT_THAT(Message(ApplyFlags({{"--nonsense", "1"}}, config)), HasSubstr("--nonsense"));
  EXPECT_THAT(Message(ApplyFlags({{"--limits-max-uploads", "many"}}, config)),
              AllOf(StartsWith("--limits-max-uploads: "), HasSubstr("\"many\"")));
}

TEST(ConfigSourcesTest, PrintedSettingsReadBackTheSame) {
  ServerConfig config;
  config.listen = "[::1]:0";
  config.data_dir = "a \"folder\"\\with\ttabs\nand lines \xC3\xA4";
  config.allow_plaintext = true;
  config.limits.max_scan_bytes = 12345;
  config.limits.memory_bytes = uint64_t{3} << 30;
  config.limits.upload_lifetime_seconds = int64_t{1} << 31;
  ServerConfig read;
  const absl::Status status = ApplyToml(ConfigToml(config), "printed", read);
  ASSERT_TRUE(status.ok()) << status << "\n" << ConfigToml(config);
  EXPECT_EQ(ConfigToml(read), ConfigToml(config));
  EXPECT_EQ(read.data_dir, config.data_dir);
  EXPECT_EQ(read.limits.memory_bytes, config.limits.memory_bytes);
  EXPECT_THAT(ConfigToml(config), HasSubstr("memory_bytes = \"3GiB\""));
}

TEST(ConfigSourcesTest, EverySettingIsReachedByEverySource) {
  for (const Setting& setting : AllSettings()) {
    const std::string text = setting.kind == SettingKind::kSwitch ? "true" : "17";
    ServerConfig by_flag;
    ServerConfig by_environment;
    ServerConfig by_file;
    const std::string quote = setting.kind == SettingKind::kText ? "'" : "";
    ASSERT_TRUE(ApplyFlags({{FlagName(setting), text}}, by_flag).ok()) << setting.key;
    ASSERT_TRUE(ApplyEnvironment({{EnvironmentName(setting), text}}, by_environment).ok()) << setting.key;
    ASSERT_TRUE(ApplyToml(TomlName(setting) + " = " + quote + text + quote, "file", by_file).ok()) << setting.key;
    EXPECT_EQ(ConfigToml(by_flag), ConfigToml(by_environment));
    EXPECT_EQ(ConfigToml(by_flag), ConfigToml(by_file));
    EXPECT_NE(ConfigToml(by_flag), ConfigToml(ServerConfig())) << setting.key;
  }
}

TEST(ConfigSourcesTest, TheTableOfTheDocumentationIsUpToDate) {
  std::ifstream file(testing::TestDataPath("../../docs/settings.md"));
  std::ostringstream text;
  text << file.rdbuf();
  EXPECT_EQ(text.str(), SettingsMarkdown()) << "run: curvereg-server --print-settings > docs/settings.md";
}

struct Size {
  const char* text;
  uint64_t bytes;
};
TEST(SettingsTest, SizesTakeUnits) {
  const Setting* memory = nullptr;
  for (const Setting& setting : AllSettings()) memory = TomlName(setting) == "limits.memory_bytes" ? &setting : memory;
  ASSERT_NE(memory, nullptr);
  for (const Size& size : {Size{"0", 0},
                           {"17", 17},
                           {"17B", 17},
                           {"2kB", 2000},
                           {"2 MB", 2'000'000},
                           {"3KiB", 3072},
                           {"512MiB", uint64_t{1} << 29},
                           {"1TiB", uint64_t{1} << 40},
                           {"1TB", 1'000'000'000'000}}) {
    ServerConfig config;
    ASSERT_TRUE(SetFromText(*memory, size.text, config).ok()) << size.text;
    EXPECT_EQ(config.limits.memory_bytes, size.bytes) << size.text;
  }
  for (const char* text :
       {"", "MiB", "-1", "1.5GiB", "1 GiB ", "17 ", "1  GiB", "1gib", "0x10", " 1", "99999999999TiB", "1e3"}) {
    ServerConfig config;
    EXPECT_FALSE(SetFromText(*memory, text, config).ok()) << text;
    EXPECT_EQ(config.limits.memory_bytes, 0u) << text;
  }
}

}  // namespace
}  // namespace curvereg::server
