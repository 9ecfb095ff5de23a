// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/connection.h"

#include <arpa/inet.h>
#include <grpcpp/create_channel.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/client/scripted_server.h"
#include "tests/testing/impairment_proxy.h"

namespace curvereg {
namespace {

using std::chrono::milliseconds;
using testing::ConnectTo;
using ::testing::HasSubstr;
using testing::ImpairmentProxy;
using testing::QuickOptions;
using testing::Script;
using testing::ScriptedServer;
using Clock = std::chrono::steady_clock;

int FreePort() { return ScriptedServer({}).port(); }

Script HealthyScript() {
  Script script;
  script.check = [](auto&, const auto& request, auto& response) {
    if (request.service() == "curvereg.v1.TraverseService") return grpc::Status(grpc::NOT_FOUND, "no such service");
    response.set_status(grpc::health::v1::HealthCheckResponse::SERVING);
    return grpc::Status::OK;
  };
  script.list_methods = [](auto&, const auto&, auto& response) {
    response.set_build_id("build 1");
    v1::MethodInfo& method = *response.add_methods();
    method.set_name("curvelet");
    method.set_description("does it");
    method.set_available(true);
    response.mutable_limits()->set_max_scan_points(77);
    response.mutable_load()->set_registrations_waiting(3);
    response.mutable_load()->set_stored_bytes(uint64_t{1} << 40);
    return grpc::Status::OK;
  };
  script.get_scan = [](auto&, const auto& request, auto& response) {
    response.mutable_scan()->set_name(request.name());
    return grpc::Status::OK;
  };
  return script;
}

TEST(ConnectTest, TellsWhyItCannot) {
  ClientOptions options = QuickOptions();
  options.connect_timeout = milliseconds(300);
  const Clock::time_point start = Clock::now();
  const auto client = Client::Connect("127.0.0.1:" + std::to_string(FreePort()), options);
  EXPECT_TRUE(absl::IsUnavailable(client.status())) << client.status();
  EXPECT_THAT(std::string(client.status().message()), HasSubstr("onnection refused"));
  EXPECT_GE(Clock::now() - start, milliseconds(290));
  EXPECT_LT(Clock::now() - start, milliseconds(3000));
}

TEST(ConnectTest, RefusesBadOptionsAtOnce) {
  EXPECT_TRUE(absl::IsInvalidArgument(Client::Connect("").status()));
  ClientOptions options;
  options.token = "secret";
  EXPECT_TRUE(absl::IsInvalidArgument(Client::Connect("rover.example.org:1", options).status()));
  options = {};
  options.tls.enabled = true;
  options.tls.ca_file = "/nowhere/ca.pem";
  EXPECT_TRUE(absl::IsInvalidArgument(Client::Connect("localhost:1", options).status()));
}

TEST(ConnectTest, FindsAServerThatComesUpInTime) {
  const int port = FreePort();
  std::unique_ptr<ScriptedServer> server;
  const std::jthread starter([&] {
    std::this_thread::sleep_for(milliseconds(300));
    server = std::make_unique<ScriptedServer>(HealthyScript(), port);
  });
  EXPECT_TRUE(Client::Connect("127.0.0.1:" + std::to_string(port), QuickOptions()).ok());
}

TEST(ConnectionTest, ACallOutlivesARestartOfTheServer) {
  auto server = std::make_unique<ScriptedServer>(HealthyScript());
  const int port = server->port();
  const auto client = ConnectTo(server->target());
  ASSERT_TRUE(client->GetScan("scans/a").ok());
  server.reset();
  const std::jthread starter([&] {
    std::this_thread::sleep_for(milliseconds(500));
    server = std::make_unique<ScriptedServer>(HealthyScript(), port);
  });
  // Far more attempts to connect than attempts of a call, which are five.
  const auto scan = client->GetScan("scans/b");
  ASSERT_TRUE(scan.ok()) << scan.status();
  EXPECT_EQ(scan->name, "scans/b");
}

TEST(ConnectionTest, ACallEndsWhenTheServerStaysAway) {
  auto server = std::make_unique<ScriptedServer>(HealthyScript());
  ClientOptions options = QuickOptions();
  options.call_timeout = milliseconds(400);
  const auto client = ConnectTo(server->target(), options);
  server.reset();
  const Clock::time_point start = Clock::now();
  EXPECT_TRUE(absl::IsUnavailable(client->GetScan("scans/a").status()));
  EXPECT_LT(Clock::now() - start, milliseconds(3000));
}

TEST(ConnectionTest, AChannelThatDoesNotComeBackIsMadeAnew) {
  const int port = FreePort();
  ClientOptions options = QuickOptions();
  options.connect_timeout = milliseconds(50);
  auto connection = internal::Connection::Open("127.0.0.1:" + std::to_string(port), options);
  ASSERT_TRUE(connection.ok()) << connection.status();
  const auto first = (*connection)->channel();
  EXPECT_TRUE(absl::IsUnavailable((*connection)->AwaitReady({{}, Clock::now() + milliseconds(400)})));
  EXPECT_NE((*connection)->channel(), first);
  const ScriptedServer server(HealthyScript(), port);
  EXPECT_TRUE((*connection)->AwaitReady({{}, Clock::now() + milliseconds(5000)}).ok());
}

TEST(ConnectionTest, WaitingIsCutShortByCancellation) {
  auto connection = internal::Connection::Open("127.0.0.1:" + std::to_string(FreePort()), QuickOptions());
  ASSERT_TRUE(connection.ok()) << connection.status();
  std::stop_source source;
  source.request_stop();
  EXPECT_TRUE(absl::IsCancelled((*connection)->AwaitReady({source.get_token(), std::nullopt})));
}

TEST(ConnectionTest, JitterDiffersBetweenClientsAndStaysInRange) {
  const auto a = internal::Connection::Over(nullptr, {});
  const auto b = internal::Connection::Over(nullptr, {});
  bool differ = false;
  for (int i = 0; i < 20; ++i) {
    const double x = a->Jitter();
    EXPECT_GE(x, 0.0);
    EXPECT_LT(x, 1.0);
    differ = differ || x != b->Jitter();
  }
  EXPECT_TRUE(differ);
}

// TCP_USER_TIMEOUT of this process's connections to `port` [ms]; -1: there is none.
int UserTimeoutOfConnectionTo(int port) {
  for (int fd = 3; fd < 1024; ++fd) {
    sockaddr_storage address{};
    socklen_t size = sizeof address;
    if (getpeername(fd, reinterpret_cast<sockaddr*>(&address), &size) != 0) continue;
    // gRPC connects by IPv6 sockets, even to IPv4 addresses.
    const in_port_t peer = address.ss_family == AF_INET6 ? reinterpret_cast<sockaddr_in6&>(address).sin6_port
                                                         : reinterpret_cast<sockaddr_in&>(address).sin_port;
    if (ntohs(peer) != port) continue;
    int timeout = -1;
    socklen_t timeout_size = sizeof timeout;
    getsockopt(fd, IPPROTO_TCP, TCP_USER_TIMEOUT, &timeout, &timeout_size);
    return timeout;
  }
  return -1;
}

TEST(ConnectionTest, SetsTcpUserTimeout) {
  const ScriptedServer server(HealthyScript());
  ClientOptions options = QuickOptions();
  options.keepalive_timeout = milliseconds(4321);
  const auto client = ConnectTo(server.target(), options);
  ASSERT_TRUE(client->GetScan("scans/a").ok());
  EXPECT_EQ(UserTimeoutOfConnectionTo(server.port()), 4321);
}

TEST(ConnectionTest, APulledCableIsNoticedByKeepalive) {
  std::atomic<int> calls = 0;
  Script script = HealthyScript();
  script.get_scan = [&](auto& context, const auto&, auto&) {
    // The first call never answers; nor can the proxy pass its end on.
    if (++calls == 1) {
      while (!context.IsCancelled()) std::this_thread::sleep_for(milliseconds(5));
    }
    return grpc::Status::OK;
  };
  const ScriptedServer server(script);
  const auto proxy = ImpairmentProxy::Start(server.port());
  ASSERT_TRUE(proxy.ok()) << proxy.status();
  ClientOptions options = QuickOptions();
  options.keepalive_interval = milliseconds(10'000);  // gRPC takes nothing shorter
  options.keepalive_timeout = milliseconds(500);
  options.call_timeout = milliseconds(60'000);
  const auto client = ConnectTo((*proxy)->target(), options);
  const std::jthread puller([&] {
    while (calls == 0) std::this_thread::sleep_for(milliseconds(5));
    (*proxy)->Abandon();
  });
  const Clock::time_point start = Clock::now();
  const auto scan = client->GetScan("scans/a");
  EXPECT_TRUE(scan.ok()) << scan.status();
  EXPECT_EQ(calls, 2);
  EXPECT_LT(Clock::now() - start, milliseconds(25'000));
}

TEST(ConnectionTest, AServerShortOfMemoryIsAskedAgain) {
  Script script;
  script.render_scan = [](auto&, const auto&, auto&) { return grpc::Status::OK; };
  grpc::ResourceQuota quota;
  quota.Resize(std::size_t{1} << 20);
  const ScriptedServer server(script, 0, &quota);
  const Scan scan = testing::StrewnScan(500'000);  // about 5 MB
  ClientOptions options = QuickOptions();
  options.retry.max_attempts = 1;
  // gRPC may also close the connection.
  std::string said;
  for (int i = 0; i < 50 && said.find("short of memory") == std::string::npos; ++i) {
    const auto refused = ConnectTo(server.target(), options)->RenderScan(std::cref(scan));
    ASSERT_FALSE(refused.ok()) << "the quota does nothing";
    said = refused.status().ToString();
  }
  EXPECT_THAT(said, HasSubstr("short of memory")) << "gRPC says it in other words now";

  options.retry.max_attempts = 200;
  const std::jthread relief([&] {
    std::this_thread::sleep_for(milliseconds(300));
    quota.Resize(std::size_t{256} << 20);
  });
  const auto pictures = ConnectTo(server.target(), options)->RenderScan(std::cref(scan));
  EXPECT_TRUE(pictures.ok()) << pictures.status();
}

TEST(StatusTest, ReadsHealthMethodsLimitsAndLoad) {
  const ScriptedServer server(HealthyScript());
  const auto status = ConnectTo(server.target())->Status();
  ASSERT_TRUE(status.ok()) << status.status();
  EXPECT_TRUE(status->serving);
  ASSERT_EQ(status->services.size(), 2U);  // the third is not there
  EXPECT_EQ(status->services[0], (std::pair<std::string, bool>("curvereg.v1.RegistrationService", true)));
  EXPECT_EQ(status->build_id, "build 1");
  ASSERT_EQ(status->methods.size(), 1U);
  EXPECT_EQ(status->methods[0].name, "curvelet");
  EXPECT_TRUE(status->methods[0].available);
  EXPECT_THAT(status->limits, ::testing::Contains(std::pair<std::string, uint64_t>("max_scan_points", 77)));
  EXPECT_THAT(status->load, ::testing::Contains(std::pair<std::string, uint64_t>("registrations_waiting", 3)));
  EXPECT_THAT(status->load, ::testing::Contains(std::pair<std::string, uint64_t>("stored_bytes", uint64_t{1} << 40)));
  EXPECT_GT(status->round_trip.count(), 0);
}

TEST(StatusTest, TellsOfAServerThatIsNotReady) {
  Script script = HealthyScript();
  script.check = [](auto&, const auto&, auto& response) {
    response.set_status(grpc::health::v1::HealthCheckResponse::NOT_SERVING);
    return grpc::Status::OK;
  };
  const ScriptedServer server(script);
  const auto status = ConnectTo(server.target())->Status();
  ASSERT_TRUE(status.ok()) << status.status();
  EXPECT_FALSE(status->serving);
  EXPECT_TRUE(status->methods.empty());
}

TEST(OverChannelTest, UsesTheChannelGiven) {
  const ScriptedServer server(HealthyScript());
  const auto client =
      Client::OverChannel(grpc::CreateChannel(server.target(), grpc::InsecureChannelCredentials()), QuickOptions());
  EXPECT_TRUE(client->GetScan("scans/a").ok());
}

}  // namespace
}  // namespace curvereg
