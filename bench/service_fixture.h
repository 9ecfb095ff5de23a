// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A real server on loopback for benchmarks, with a store in a temporary folder that goes with it.
#ifndef CURVEREG_BENCH_SERVICE_FIXTURE_H_
#define CURVEREG_BENCH_SERVICE_FIXTURE_H_

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>

#include "client/client.h"
#include "program/heap_tuning.h"
#include "server/server.h"

namespace curvereg::bench {

[[noreturn]] inline void Fail(const std::string& message) {
  std::fprintf(stderr, "%s\n", message.c_str());
  std::exit(1);
}

// A new folder that goes with all it holds. Ends the program with a message when it cannot be made.
class ScratchFolder {
 public:
  ScratchFolder() {
    if (mkdtemp(path_.data()) == nullptr) Fail("no temporary folder");
  }
  ~ScratchFolder() {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_ = (std::filesystem::temp_directory_path() / "curvereg-bench-XXXXXX").string();
};

// Ends the program with a message when the server cannot be started or reached.
class LoopbackService {
 public:
  explicit LoopbackService(const server::LimitsConfig& limits = {}, const server::TlsConfig& tls = {}) {
    KeepFreedMemory();
    server::ServerConfig config;
    config.listen = "127.0.0.1:0";
    config.ops_listen = "";
    config.data_dir = folder_.path();
    config.limits = limits;
    config.tls = tls;
    config.log.level = "error";
    config.drain_delay_ms = 0;
    auto server = server::Server::Start(config);
    if (!server.ok()) Fail(std::string(server.status().message()));
    server_ = *std::move(server);
  }

  std::string target() const { return "127.0.0.1:" + std::to_string(server_->port()); }
  std::unique_ptr<Client> Connect(const ClientOptions& options = {}) const {
    auto client = Client::Connect(target(), options);
    if (!client.ok()) Fail(std::string(client.status().message()));
    return *std::move(client);
  }

 private:
  ScratchFolder folder_;  // outlives the server
  std::unique_ptr<server::Server> server_;
};

}  // namespace curvereg::bench

#endif  // CURVEREG_BENCH_SERVICE_FIXTURE_H_
