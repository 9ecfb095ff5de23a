// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/testing/server_process.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

namespace curvereg::testing {
namespace {

constexpr std::chrono::seconds kStartPatience{60};  // sanitizers are slow
constexpr std::chrono::milliseconds kPoll{5};

// Only async-signal-safe calls between fork and exec.
pid_t Spawn(const std::vector<std::string>& words, const std::string& log) {
  std::vector<char*> pointers;
  for (const std::string& word : words) pointers.push_back(const_cast<char*>(word.c_str()));
  pointers.push_back(nullptr);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child != 0) return child;
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // a test that crashes leaves no server behind
  if (getppid() != parent) _exit(127);
  const int file = open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
  if (file >= 0) {
    dup2(file, STDOUT_FILENO);
    dup2(file, STDERR_FILENO);
  }
  execv(pointers[0], pointers.data());
  _exit(127);
}

}  // namespace

ServerProcess::ServerProcess(const std::string& executable, const std::string& folder,
                             const std::vector<std::string>& arguments)
    : executable_(executable), folder_(folder), arguments_(arguments) {
  Start("127.0.0.1:0", "127.0.0.1:0");
}

ServerProcess::~ServerProcess() { Kill(); }

bool ServerProcess::Start(const std::string& listen, const std::string& ops_listen) {
  const std::string ports_file = folder_ + "/ports.json";
  std::filesystem::remove(ports_file);
  std::vector<std::string> words = {executable_,       "--ops-listen", ops_listen, "--data-dir",
                                    folder_ + "/data", "--ports-file", ports_file};
  const bool has_address = std::find(arguments_.begin(), arguments_.end(), "--listen") != arguments_.end();
  if (!has_address) words.insert(words.end(), {"--listen", listen});
  words.insert(words.end(), arguments_.begin(), arguments_.end());
  pid_ = Spawn(words, folder_ + "/server.log");
  const auto give_up = std::chrono::steady_clock::now() + kStartPatience;
  while (std::chrono::steady_clock::now() < give_up) {
    if (waitpid(pid_, nullptr, WNOHANG) == pid_) {
      pid_ = -1;
      return false;
    }
    std::ifstream file(ports_file);
    const nlohmann::json ports = nlohmann::json::parse(file, nullptr, false);
    if (!ports.is_discarded()) {
      port_ = ports["grpc_port"];
      ops_port_ = ports["ops_port"];
      return true;
    }
    std::this_thread::sleep_for(kPoll);
  }
  Kill();
  return false;
}

bool ServerProcess::Restart() {
  Kill();
  return Start("127.0.0.1:" + std::to_string(port_), "127.0.0.1:" + std::to_string(ops_port_));
}

int ServerProcess::Wait(std::chrono::milliseconds patience) {
  const auto give_up = std::chrono::steady_clock::now() + patience;
  int status = 0;
  while (waitpid(pid_, &status, WNOHANG) != pid_) {
    if (std::chrono::steady_clock::now() >= give_up) return -1;
    std::this_thread::sleep_for(kPoll);
  }
  pid_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void ServerProcess::AskToStop() const {
  if (pid_ > 0) kill(pid_, SIGTERM);
}

int ServerProcess::Terminate(std::chrono::seconds patience) {
  if (pid_ <= 0) return -1;
  AskToStop();
  return Wait(patience);
}

void ServerProcess::Kill() {
  if (pid_ <= 0) return;
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
  pid_ = -1;
}

uint64_t ServerProcess::ResidentBytes() const {
  if (pid_ <= 0) return 0;
  std::ifstream file("/proc/" + std::to_string(pid_) + "/statm");
  uint64_t total_pages = 0, resident_pages = 0;
  file >> total_pages >> resident_pages;
  return resident_pages * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
}

std::string ServerProcess::Get(const std::string& path, int* status) const {
  const int connection = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<uint16_t>(ops_port_));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  std::string answer;
  if (connect(connection, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) {
    const std::string request = "GET " + path + " HTTP/1.0\r\nHost: localhost\r\n\r\n";
    static_cast<void>(send(connection, request.data(), request.size(), MSG_NOSIGNAL));
    char piece[4096];
    for (ssize_t size = 0; (size = recv(connection, piece, sizeof(piece), 0)) > 0;) {
      answer.append(piece, static_cast<std::size_t>(size));
    }
  }
  close(connection);
  if (status != nullptr) *status = answer.size() > 12 ? std::atoi(answer.c_str() + 9) : 0;
  const std::size_t body = answer.find("\r\n\r\n");
  return body == std::string::npos ? std::string() : answer.substr(body + 4);
}

}  // namespace curvereg::testing
