// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/service_access.h"

#include <sys/socket.h>

#include <chrono>
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/traverses.h"
#include "server/server.h"
#include "tests/testing/certificates.h"
#include "tests/testing/silent_server.h"
#include "tests/testing/test_data.h"

namespace curvereg::cli {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using Clock = std::chrono::steady_clock;

// Sockets of this process that others can connect to.
int NumListeningSockets() {
  int count = 0;
  for (int file = 0; file < 1024; ++file) {
    int is_listening = 0;
    socklen_t size = sizeof(is_listening);
    if (getsockopt(file, SOL_SOCKET, SO_ACCEPTCONN, &is_listening, &size) == 0) count += is_listening;
  }
  return count;
}

std::string ErrorOf(const ServerArguments& arguments) {
  return std::string(ServiceAccess::Open(arguments, {}).status().message());
}

TEST(ServiceAccess, NeedsAHostAndAPort) {
  for (const char* server : {"127.0.0.1", "127.0.0.1:", "127.0.0.1:0", "127.0.0.1:abc", "127.0.0.1:107423", ":50051",
                             "127.0.0.1:50051/", "http://127.0.0.1:50051", "::1:50051"}) {
    ServerArguments arguments;
    arguments.server = server;
    const absl::Status status = ServiceAccess::Open(arguments, {}).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << server << ": " << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr("HOST:PORT"));
  }
}

TEST(ServiceAccess, WorksOnADataFolderWithoutAPort) {
  const testing::TemporaryFolder folder;
  absl::StatusOr<ServiceAccess> service = ServiceAccess::OpenWithData({}, folder.File("data"), {});
  ASSERT_TRUE(service.ok()) << service.status();
  EXPECT_EQ(NumListeningSockets(), 0);
  EXPECT_TRUE(service->client().traverses().Create("drive", {}).ok());
  EXPECT_TRUE(service->client().Status()->serving);
  const testing::SilentServer other;
  EXPECT_EQ(NumListeningSockets(), 1) << "the count finds what listens";
}

TEST(ServiceAccess, CleaningUpDoesNotWaitLong) {
  const testing::SilentServer server;
  ServerArguments arguments;
  arguments.server = server.target();
  arguments.timeout_s = 60.0;
  Clock::time_point start;
  {
    absl::StatusOr<ServiceAccess> service = ServiceAccess::Open(arguments, {});
    ASSERT_TRUE(service.ok()) << service.status();
    service->DeleteAtEnd("scans/1");
    service->DeleteAtEnd("scans/2");
    start = Clock::now();
  }
  EXPECT_LT(Clock::now() - start, std::chrono::seconds(15));
}

TEST(ServiceAccess, GivesAdviceWhenOneSideSpeaksTlsOnly) {
  if (!testing::HasOpenssl()) GTEST_SKIP() << "the openssl command is missing";
  const testing::TemporaryFolder folder;
  const testing::Certificates certificates(folder.path());
  certificates.MakeAuthority("ca");
  certificates.MakeLeaf("server", "ca", "IP:127.0.0.1");
  server::ServerConfig config;
  config.listen = "127.0.0.1:0";
  config.ops_listen.clear();
  config.log.level = "error";
  config.drain_delay_ms = 0;
  config.data_dir = folder.File("plain");
  const auto plain = server::Server::Start(config);
  ASSERT_TRUE(plain.ok()) << plain.status();
  config.tls = {.certificate_file = certificates.Pem("server"),
                .key_file = certificates.Key("server"),
                .client_ca_file = certificates.Pem("ca")};
  config.data_dir = folder.File("mutual");
  const auto mutual = server::Server::Start(config);
  ASSERT_TRUE(mutual.ok()) << mutual.status();

  ServerArguments arguments;
  arguments.timeout_s = 1.0;
  arguments.server = "127.0.0.1:" + std::to_string((*mutual)->port());
  EXPECT_THAT(ErrorOf(arguments), EndsWith("give --tls or --tls-ca"));
  arguments.ca = certificates.Pem("ca");
  EXPECT_THAT(ErrorOf(arguments), EndsWith("give --tls-cert and --tls-key"));
  arguments.server = "127.0.0.1:" + std::to_string((*plain)->port());
  EXPECT_THAT(ErrorOf(arguments), EndsWith("omit --tls, --tls-ca and --tls-cert"));
}

}  // namespace
}  // namespace curvereg::cli
