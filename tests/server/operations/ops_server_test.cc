// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/operations/ops_server.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <string>

namespace curvereg::server {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

int Connect(int port) {
  const int fd = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) return fd;
  close(fd);
  return -1;
}

// All that the server answers to these bytes until it closes.
std::string Exchange(int port, const std::string& request) {
  const int fd = Connect(port);
  if (fd < 0) return "not connected";
  static_cast<void>(send(fd, request.data(), request.size(), MSG_NOSIGNAL));
  std::string answer;
  char buffer[4096];
  for (ssize_t n = 0; (n = read(fd, buffer, sizeof(buffer))) > 0;) answer.append(buffer, static_cast<std::size_t>(n));
  close(fd);
  return answer;
}

std::string Get(int port, const std::string& path, const std::string& method = "GET") {
  return Exchange(port, method + " " + path + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
}

class OpsServerTest : public ::testing::Test {
 protected:
  OpsServerTest() {
    server_ = *OpsServer::Start("127.0.0.1:0", {.metrics = [] { return std::string("a_metric 1\n"); },
                                                .not_ready = [this] { return not_ready_; }});
  }
  std::string not_ready_;
  std::unique_ptr<OpsServer> server_;
};

TEST_F(OpsServerTest, GivesMetrics) {
  ASSERT_GT(server_->port(), 0);
  const std::string answer = Get(server_->port(), "/metrics");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(answer, HasSubstr("Content-Type: text/plain; version=0.0.4"));
  EXPECT_THAT(answer, HasSubstr("Content-Length: 11\r\n"));
  EXPECT_THAT(answer, EndsWith("\r\n\r\na_metric 1\n"));
}

TEST_F(OpsServerTest, IsReadyOnlyWhenItIs) {
  EXPECT_THAT(Get(server_->port(), "/readyz"), StartsWith("HTTP/1.1 200 "));
  not_ready_ = "draining";
  EXPECT_THAT(Get(server_->port(), "/readyz"), StartsWith("HTTP/1.1 503 "));
  EXPECT_THAT(Get(server_->port(), "/readyz"), EndsWith("not ready: draining\n"));
  EXPECT_THAT(Get(server_->port(), "/livez"), StartsWith("HTTP/1.1 200 "));
}

TEST_F(OpsServerTest, HeadHasNoBody) {
  const std::string answer = Get(server_->port(), "/metrics", "HEAD");
  EXPECT_THAT(answer, HasSubstr("Content-Length: 11\r\n"));
  EXPECT_THAT(answer, EndsWith("\r\n\r\n"));
}

TEST_F(OpsServerTest, TakesNothingElse) {
  for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS"}) {
    EXPECT_THAT(Get(server_->port(), "/metrics", method), StartsWith("HTTP/1.1 405 ")) << method;
  }
  for (const char* path : {"/", "/metrics/", "/metricsx", "/../etc/passwd", "/%2e%2e/etc/passwd"}) {
    EXPECT_THAT(Get(server_->port(), path), ::testing::MatchesRegex("HTTP/1.1 40[04] (.|\n)*")) << path;
  }
  EXPECT_THAT(Get(server_->port(), "/livez?x=1"), StartsWith("HTTP/1.1 200 "));
}

TEST_F(OpsServerTest, BoundsWhatItReads) {
  const std::string answer = Exchange(server_->port(), "GET /livez HTTP/1.1\r\nX: " + std::string(20000, 'a'));
  EXPECT_THAT(answer, ::testing::Not(StartsWith("HTTP/1.1 200 ")));
  EXPECT_THAT(Exchange(server_->port(), std::string("\0\1\2garbage\r\n\r\n", 14)),
              ::testing::Not(StartsWith("HTTP/1.1 200 ")));
  EXPECT_THAT(Get(server_->port(), "/livez"), StartsWith("HTTP/1.1 200 "));  // and goes on
}

TEST_F(OpsServerTest, SilentClientsDoNotHoldTheOthersUp) {
  std::array<int, 20> silent{};
  for (int& fd : silent) {
    fd = Connect(server_->port());
    ASSERT_GE(fd, 0);
  }
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_THAT(Get(server_->port(), "/livez"), StartsWith("HTTP/1.1 200 "));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1)) << "the patience of a liveness probe";
  for (const int fd : silent) close(fd);
}

TEST_F(OpsServerTest, ListensOnItsAddressAlone) {
  const int port = server_->port();
  EXPECT_EQ(OpsServer::Start("127.0.0.1:" + std::to_string(port), {}).status().code(), absl::StatusCode::kUnavailable);
  const auto begin = std::chrono::steady_clock::now();
  server_.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(1500));
  EXPECT_EQ(Get(port, "/livez"), "not connected");
}

TEST(OpsServerAddressTest, RefusesWhatIsNoAddress) {
  EXPECT_EQ(OpsServer::Start("nonsense", {}).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(OpsServer::Start("203.0.113.1:0", {}).status().code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(OpsServer::Start("no-such-host.invalid:0", {}).status().code(), absl::StatusCode::kUnavailable);
  EXPECT_GT((*OpsServer::Start("localhost:0", {}))->port(), 0);
}

TEST(OpsServerAddressTest, SaysWhenTheLibraryKnowsNoIpv6) {  // Debian's does not
  const auto server = OpsServer::Start("[::1]:0", {});
  if (server.ok()) GTEST_SKIP() << "the HTTP library of this build knows IPv6";
  EXPECT_EQ(server.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(server.status().message()), HasSubstr("ops_listen"));
  EXPECT_THAT(std::string(server.status().message()), HasSubstr("IPv6"));
}

}  // namespace
}  // namespace curvereg::server
