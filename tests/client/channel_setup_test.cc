// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/channel_setup.h"

#include <grpc/grpc.h>

#include <fstream>
#include <map>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/testing/test_data.h"

namespace curvereg::internal {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;

TEST(IsLoopbackTargetTest, KnowsThisMachine) {
  for (const char* target :
       {"localhost:50051", "LOCALHOST", "127.0.0.1:1", "127.1.2.3", "[::1]:50051", "::1", "dns:localhost:1",
        "dns:///localhost:1", "ipv4:127.0.0.1:1", "ipv4:127.0.0.1:1,127.0.0.2:1", "ipv6:[::1]:1", "unix:/run/x.sock",
        "unix:///run/x.sock", "unix-abstract:x"}) {
    EXPECT_TRUE(IsLoopbackTarget(target)) << target;
  }
}

TEST(IsLoopbackTargetTest, TakesNothingElseForThisMachine) {
  for (const char* target : {"", "rover:50051", "localhost.example.org:1", "127.0.0.1.example.org:1", "10.0.0.1:1",
                             "1127.0.0.1", "127.0.0", "127.0.0.256", "[2001:db8::1]:1", "ipv4:127.0.0.1:1,10.0.0.1:1",
                             "dns://10.0.0.1/localhost:1", "xds:///localhost", "0.0.0.0:1"}) {
    EXPECT_FALSE(IsLoopbackTarget(target)) << target;
  }
}

std::string ErrorFor(const std::string& target, const ClientOptions& options) {
  const absl::Status status = ValidateOptions(target, options);
  EXPECT_TRUE(status.ok() || absl::IsInvalidArgument(status)) << status;
  return std::string(status.message());
}

TEST(ValidateOptionsTest, AcceptsTheDefaults) { EXPECT_TRUE(ValidateOptions("rover:50051", {}).ok()); }

TEST(ValidateOptionsTest, NamesTheOptionThatIsOutOfRange) {
  EXPECT_THAT(ErrorFor("", {}), HasSubstr("address"));
  ClientOptions options;
  options.connect_timeout = milliseconds(0);
  EXPECT_THAT(ErrorFor("a:1", options), HasSubstr("connect_timeout"));
  options = {};
  options.call_timeout = milliseconds(-1);
  EXPECT_THAT(ErrorFor("a:1", options), HasSubstr("call_timeout"));
  options = {};
  options.keepalive_interval = milliseconds(0);
  EXPECT_THAT(ErrorFor("a:1", options), HasSubstr("keepalive_interval"));
  options = {};
  options.keepalive_timeout = milliseconds(0);
  EXPECT_THAT(ErrorFor("a:1", options), HasSubstr("keepalive_timeout"));
  options = {};
  options.retry.max_attempts = 0;
  EXPECT_THAT(ErrorFor("a:1", options), HasSubstr("max_attempts"));
  options = {};
  options.retry.initial_backoff = milliseconds(0);
  EXPECT_THAT(ErrorFor("a:1", options), HasSubstr("initial_backoff"));
  options = {};
  options.retry.max_backoff = milliseconds(0);
  EXPECT_THAT(ErrorFor("a:1", options), HasSubstr("max_backoff"));
}

TEST(ValidateOptionsTest, KeepsTheTokenOffPlainNetworks) {
  ClientOptions options;
  options.token = "secret";
  EXPECT_TRUE(ValidateOptions("localhost:1", options).ok());
  const std::string error = ErrorFor("rover:1", options);
  EXPECT_THAT(error, HasSubstr("plain text"));
  EXPECT_EQ(error.find("secret"), std::string::npos);
  options.tls.enabled = true;
  EXPECT_TRUE(ValidateOptions("rover:1", options).ok());
  options.token = "two words";
  EXPECT_THAT(ErrorFor("rover:1", options), HasSubstr("token"));
  options.token = "line\n";
  EXPECT_THAT(ErrorFor("rover:1", options), HasSubstr("token"));
}

TEST(ValidateOptionsTest, RefusesTlsOptionsThatWouldHaveNoEffect) {
  ClientOptions options;
  options.tls.ca_file = "ca.pem";
  EXPECT_THAT(ErrorFor("a:1", options), HasSubstr("not enabled"));
  options.tls.enabled = true;
  EXPECT_TRUE(ValidateOptions("a:1", options).ok());
  options.tls.key_file = "key.pem";
  EXPECT_THAT(ErrorFor("a:1", options), HasSubstr("certificate_file"));
}

TlsOptions TlsWithAuthority(const std::string& ca_file) {
  TlsOptions tls;
  tls.enabled = true;
  tls.ca_file = ca_file;
  return tls;
}

TEST(MakeCredentialsTest, NamesTheFileThatCannotBeRead) {
  EXPECT_TRUE(MakeCredentials({}).ok());
  EXPECT_TRUE(MakeCredentials(TlsWithAuthority("")).ok());
  const testing::TemporaryFolder folder;
  std::ofstream(folder.File("empty.pem")).close();
  for (const char* name : {"none.pem", "empty.pem"}) {
    const auto credentials = MakeCredentials(TlsWithAuthority(folder.File(name)));
    ASSERT_TRUE(absl::IsInvalidArgument(credentials.status())) << credentials.status();
    EXPECT_THAT(std::string(credentials.status().message()), HasSubstr(name));
  }
  EXPECT_TRUE(absl::IsInvalidArgument(MakeCredentials(TlsWithAuthority(folder.path())).status()));
}

std::map<std::string, int> IntegerArguments(const std::string& target, const ClientOptions& options) {
  const grpc::ChannelArguments made = MakeChannelArguments(target, options);
  grpc_channel_args arguments{};
  made.SetChannelArgs(&arguments);
  std::map<std::string, int> result;
  for (size_t i = 0; i < arguments.num_args; ++i) {
    if (arguments.args[i].type == GRPC_ARG_INTEGER) result[arguments.args[i].key] = arguments.args[i].value.integer;
  }
  return result;
}

TEST(MakeChannelArgumentsTest, CarriesTheOptions) {
  ClientOptions options;
  options.keepalive_interval = milliseconds(1234);
  options.keepalive_timeout = milliseconds(567);
  options.retry.initial_backoff = milliseconds(89);
  options.retry.max_backoff = milliseconds(1011);
  std::map<std::string, int> arguments = IntegerArguments("rover:1", options);
  EXPECT_EQ(arguments[GRPC_ARG_KEEPALIVE_TIME_MS], 1234);
  EXPECT_EQ(arguments[GRPC_ARG_KEEPALIVE_TIMEOUT_MS], 567);
  EXPECT_EQ(arguments[GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS], 89);
  EXPECT_EQ(arguments[GRPC_ARG_MAX_RECONNECT_BACKOFF_MS], 1011);
  ASSERT_EQ(arguments.count(GRPC_ARG_ENABLE_RETRIES), 1U);
  EXPECT_EQ(arguments[GRPC_ARG_ENABLE_RETRIES], 0);
  EXPECT_EQ(arguments.count(GRPC_ARG_ENABLE_HTTP_PROXY), 0U);
}

TEST(MakeChannelArgumentsTest, LeavesProxiesOutOnThisMachine) {
  std::map<std::string, int> arguments = IntegerArguments("localhost:1", {});
  ASSERT_EQ(arguments.count(GRPC_ARG_ENABLE_HTTP_PROXY), 1U);
  EXPECT_EQ(arguments[GRPC_ARG_ENABLE_HTTP_PROXY], 0);
}

TEST(MakeChannelArgumentsTest, SurvivesTimesBeyondAnInteger) {
  ClientOptions options;
  options.keepalive_interval = std::chrono::hours(24 * 365 * 10);
  EXPECT_GT(IntegerArguments("a:1", options)[GRPC_ARG_KEEPALIVE_TIME_MS], 0);
}

}  // namespace
}  // namespace curvereg::internal
