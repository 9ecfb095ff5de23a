// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Connections come about, and then no call is ever answered.
#ifndef CURVEREG_TESTS_TESTING_SILENT_SERVER_H_
#define CURVEREG_TESTS_TESTING_SILENT_SERVER_H_

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace curvereg::testing {

class SilentServer {
 public:
  SilentServer() : listener_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    auto* any = reinterpret_cast<sockaddr*>(&address);
    EXPECT_EQ(bind(listener_, any, size), 0);
    EXPECT_EQ(listen(listener_, 16), 0);
    EXPECT_EQ(getsockname(listener_, any, &size), 0);
    port_ = ntohs(address.sin_port);
    thread_ = std::jthread([this] { Accept(); });
  }
  ~SilentServer() {
    shutdown(listener_, SHUT_RDWR);  // ends accept()
    thread_.join();
    for (const int connection : connections_) close(connection);
    close(listener_);
  }
  SilentServer(const SilentServer&) = delete;
  SilentServer& operator=(const SilentServer&) = delete;

  std::string target() const { return "127.0.0.1:" + std::to_string(port_); }

 private:
  void Accept() {
    constexpr char kEmptySettings[] = {0, 0, 0, 4, 0, 0, 0, 0, 0};  // HTTP/2's first frame of a server
    while (true) {
      const int connection = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
      if (connection < 0) return;
      connections_.push_back(connection);
      EXPECT_EQ(send(connection, kEmptySettings, sizeof(kEmptySettings), MSG_NOSIGNAL), ssize_t{9});
    }
  }

  int listener_;
  int port_ = 0;
  std::vector<int> connections_;  // of the thread, until it has ended
  std::jthread thread_;
};

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_TESTING_SILENT_SERVER_H_
