// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The built curvereg-server as a child process on free loopback ports.
#ifndef CURVEREG_TESTS_TESTING_SERVER_PROCESS_H_
#define CURVEREG_TESTS_TESTING_SERVER_PROCESS_H_

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace curvereg::testing {

class ServerProcess {
 public:
  // Starts `executable` with its data in `folder`/data and its log in `folder`/server.log, and waits until it is ready.
  // `arguments` come after ours. port() is 0 when it ended instead.
  ServerProcess(const std::string& executable, const std::string& folder, const std::vector<std::string>& arguments);
  ~ServerProcess();  // Kill()
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

  int port() const { return port_; }
  int ops_port() const { return ops_port_; }
  std::string target() const { return "127.0.0.1:" + std::to_string(port_); }
  pid_t pid() const { return pid_; }

  // SIGTERM, then waits. Exit status, or -1 when it did not end in time or died of a signal.
  int Terminate(std::chrono::seconds patience = std::chrono::seconds(40));
  // SIGTERM without waiting.
  void AskToStop() const;
  // SIGKILL, then waits. Does nothing when it has ended.
  void Kill();
  // Starts it anew on the same ports and folder; returns false when it is not ready in time.
  bool Restart();

  // Resident memory [bytes]; 0 when it has ended.
  uint64_t ResidentBytes() const;
  // Body of http://127.0.0.1:ops_port/path; empty when there is none. `status` gets the HTTP status.
  std::string Get(const std::string& path, int* status = nullptr) const;

 private:
  bool Start(const std::string& listen, const std::string& ops_listen);
  int Wait(std::chrono::milliseconds patience);

  std::string executable_;
  std::string folder_;
  std::vector<std::string> arguments_;
  pid_t pid_ = -1;
  int port_ = 0;
  int ops_port_ = 0;
};

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_TESTING_SERVER_PROCESS_H_
