// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/testing/impairment_proxy.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace curvereg::testing {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

sockaddr_in Loopback(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<uint16_t>(port));
  return address;
}

// Sends back what it gets, one thread a connection.
class EchoServer {
 public:
  EchoServer() : listener_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address = Loopback(0);
    bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address);
    listen(listener_, 16);
    socklen_t size = sizeof address;
    getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    acceptor_ = std::jthread([this] {
      for (int fd = accept(listener_, nullptr, nullptr); fd >= 0; fd = accept(listener_, nullptr, nullptr)) {
        echoes_.emplace_back([fd] { Echo(fd); });
      }
    });
  }
  // The clients' connections must be closed before.
  ~EchoServer() {
    shutdown(listener_, SHUT_RDWR);
    acceptor_.join();
    close(listener_);
  }
  int port() const { return port_; }

 private:
  static void Echo(int fd) {
    std::string buffer(64 * 1024, '\0');
    for (ssize_t count = 0; (count = recv(fd, buffer.data(), buffer.size(), 0)) > 0;) {
      if (send(fd, buffer.data(), static_cast<size_t>(count), MSG_NOSIGNAL) < 0) break;
    }
    close(fd);
  }

  int listener_;
  int port_ = 0;
  std::vector<std::jthread> echoes_;
  std::jthread acceptor_;
};

class Connection {
 public:
  explicit Connection(int port) : fd_(socket(AF_INET, SOCK_STREAM, 0)) {
    const sockaddr_in address = Loopback(port);
    connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address);
  }
  ~Connection() { close(fd_); }

  bool Send(const std::string& bytes) const {
    return send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size());
  }
  // Up to `size` bytes; fewer at the end, after an error (then error() tells it), or when `patience` is over.
  std::string Receive(size_t size, milliseconds patience = milliseconds(5000)) {
    std::string bytes(size, '\0');
    size_t count = 0;
    const Clock::time_point end = Clock::now() + patience;
    while (count < size) {
      pollfd polled{fd_, POLLIN, 0};
      const auto left = std::chrono::ceil<milliseconds>(end - Clock::now());
      if (left.count() <= 0 || poll(&polled, 1, static_cast<int>(left.count())) <= 0) break;
      const ssize_t got = recv(fd_, bytes.data() + count, size - count, 0);
      error_ = got < 0 ? errno : 0;
      if (got <= 0) break;
      count += static_cast<size_t>(got);
    }
    return bytes.substr(0, count);
  }
  int error() const { return error_; }

 private:
  int fd_;
  int error_ = 0;
};

std::unique_ptr<ImpairmentProxy> StartProxy(int port, const LinkOptions& options = {}) {
  auto proxy = ImpairmentProxy::Start(port, options);
  EXPECT_TRUE(proxy.ok()) << proxy.status();
  return *std::move(proxy);
}

TEST(ImpairmentProxyTest, PassesBytesBothWaysAndCountsThem) {
  const EchoServer server;
  const auto proxy = StartProxy(server.port());
  Connection connection(proxy->port());
  const std::string sent(300'000, 'x');
  ASSERT_TRUE(connection.Send(sent));
  EXPECT_EQ(connection.Receive(sent.size()), sent);
  EXPECT_EQ(proxy->statistics().bytes_to_server, sent.size());
  EXPECT_EQ(proxy->statistics().bytes_to_client, sent.size());
  EXPECT_EQ(proxy->statistics().num_connections, 1);
}

TEST(ImpairmentProxyTest, DelaysEachWayAndANewConnectionLonger) {
  const EchoServer server;
  const auto proxy = StartProxy(server.port(), {.one_way_delay = milliseconds(60)});
  Connection connection(proxy->port());
  Clock::time_point start = Clock::now();
  ASSERT_TRUE(connection.Send("first"));
  EXPECT_EQ(connection.Receive(5), "first");
  EXPECT_GE(SecondsSince(start), 0.235);  // there and back, and the connection itself as long
  start = Clock::now();
  ASSERT_TRUE(connection.Send("next"));
  EXPECT_EQ(connection.Receive(4), "next");
  EXPECT_GE(SecondsSince(start), 0.119);
  EXPECT_LT(SecondsSince(start), 0.235);
}

TEST(ImpairmentProxyTest, BoundsTheRateAndHoldsTheSenderBack) {
  const EchoServer server;
  const auto proxy = StartProxy(server.port(), {.bytes_per_second = 200e3});
  Connection connection(proxy->port());
  const std::string sent(100'000, 'y');
  const Clock::time_point start = Clock::now();
  ASSERT_TRUE(connection.Send(sent));
  EXPECT_EQ(connection.Receive(sent.size()).size(), sent.size());
  EXPECT_GE(SecondsSince(start), 0.49);
  EXPECT_LT(SecondsSince(start), 1.5);
  // What has not passed the link has not been read from the client either: no endless buffer.
  ASSERT_TRUE(connection.Send(sent));
  std::this_thread::sleep_for(milliseconds(50));
  EXPECT_LT(proxy->statistics().bytes_to_server, sent.size() + 50'000);
}

TEST(ImpairmentProxyTest, CutsWithResetThenRefusesForAWhile) {
  const EchoServer server;
  const auto proxy = StartProxy(server.port());
  Connection connection(proxy->port());
  ASSERT_TRUE(connection.Send("a"));
  ASSERT_EQ(connection.Receive(1), "a");
  proxy->Cut(milliseconds(300));
  EXPECT_EQ(connection.Receive(1), "");
  EXPECT_EQ(connection.error(), ECONNRESET);
  Connection refused(proxy->port());
  EXPECT_EQ(refused.Receive(1), "");
  EXPECT_EQ(refused.error(), ECONNRESET);
  std::this_thread::sleep_for(milliseconds(320));
  Connection again(proxy->port());
  ASSERT_TRUE(again.Send("c"));
  EXPECT_EQ(again.Receive(1), "c");
  EXPECT_EQ(proxy->statistics().num_cuts, 1);
}

TEST(ImpairmentProxyTest, CutsByItself) {
  const EchoServer server;
  const auto proxy = StartProxy(server.port(), {.cut_every = milliseconds(200)});
  Connection connection(proxy->port());
  ASSERT_TRUE(connection.Send("a"));
  ASSERT_EQ(connection.Receive(2, milliseconds(1000)), "a");
  EXPECT_EQ(connection.error(), ECONNRESET);
  EXPECT_GE(proxy->statistics().num_cuts, 1);
}

TEST(ImpairmentProxyTest, StallsWithoutLosingAnything) {
  const EchoServer server;
  const auto proxy = StartProxy(server.port());
  Connection connection(proxy->port());
  ASSERT_TRUE(connection.Send("a"));
  ASSERT_EQ(connection.Receive(1), "a");
  proxy->Stall();
  ASSERT_TRUE(connection.Send("b"));
  EXPECT_EQ(connection.Receive(1, milliseconds(100)), "");
  EXPECT_EQ(connection.error(), 0);
  proxy->Resume();
  EXPECT_EQ(connection.Receive(1), "b");
}

TEST(ImpairmentProxyTest, AbandonsConnectionsForEver) {
  const EchoServer server;
  const auto proxy = StartProxy(server.port());
  Connection connection(proxy->port());
  ASSERT_TRUE(connection.Send("a"));
  ASSERT_EQ(connection.Receive(1), "a");
  proxy->Abandon();
  ASSERT_TRUE(connection.Send("b"));
  EXPECT_EQ(connection.Receive(1, milliseconds(100)), "");
  Connection other(proxy->port());
  ASSERT_TRUE(other.Send("c"));
  EXPECT_EQ(other.Receive(1), "c");
}

TEST(ImpairmentProxyTest, CorruptsOneByteOnce) {
  const EchoServer server;
  const auto proxy = StartProxy(server.port());
  proxy->CorruptByte(Direction::kToServer, 2);
  Connection connection(proxy->port());
  ASSERT_TRUE(connection.Send("aaaa"));
  EXPECT_EQ(connection.Receive(4), "aa`a");
  ASSERT_TRUE(connection.Send("aaaa"));
  EXPECT_EQ(connection.Receive(4), "aaaa");
}

TEST(ImpairmentProxyTest, ResetsWhenNobodyListens) {
  int port = 0;
  {
    const EchoServer gone;
    port = gone.port();
  }
  const auto proxy = StartProxy(port);
  Connection connection(proxy->port());
  connection.Send("a");
  EXPECT_EQ(connection.Receive(1), "");
}

}  // namespace
}  // namespace curvereg::testing
