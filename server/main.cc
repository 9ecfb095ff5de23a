// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// curvereg-server: exit status 0 after a shutdown that was asked for, 1 when it cannot serve, 2 for wrong settings.
#include <google/protobuf/stubs/logging.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <new>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <variant>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/register_scans.h"
#include "files/atomic_file.h"
#include "program/heap_tuning.h"
#include "program/termination_signals.h"
#include "server/access/access.h"
#include "server/access/token_file.h"
#include "server/command_line.h"
#include "server/operations/grpc_log.h"
#include "server/operations/logging.h"
#include "server/server.h"
#include "server/settings/config_sources.h"
#include "server/settings/settings.h"
#include "server/settings/small_file.h"

namespace curvereg::server {
namespace {

enum class ExitStatus { kDone = 0, kFailed = 1, kUsage = 2 };

ExitStatus StatusOfFailure(const absl::Status& status) {
  return status.code() == absl::StatusCode::kInvalidArgument ? ExitStatus::kUsage : ExitStatus::kFailed;
}

ExitStatus Fail(const absl::Status& status) {
  std::fprintf(stderr, "curvereg-server: %s\n", std::string(status.message()).c_str());
  return StatusOfFailure(status);
}

ExitStatus Fail(const absl::Status& status, Logger& logger) {
  logger.Error("cannot_start", {{"message", std::string(status.message())}});
  return StatusOfFailure(status);
}

// A file of the last run would tell wrong ports to those who wait for it.
void RemoveOldPorts(const std::string& path) {
  std::error_code ignored;  // a file that cannot be removed cannot be replaced either: WritePorts tells
  if (std::filesystem::is_regular_file(path, ignored)) std::filesystem::remove(path, ignored);
}

absl::Status WritePorts(const std::string& path, const Server& server) {
  if (path.empty()) return absl::OkStatus();
  const nlohmann::ordered_json ports = {{"grpc_port", server.port()}, {"ops_port", server.ops_port()}};
  const absl::Status status = WriteFileAtomically(path, ports.dump() + "\n");
  return status.ok() ? status : absl::Status(status.code(), absl::StrCat("--ports-file: ", status.message()));
}

void LogListening(const ServerConfig& config, const Server& server, Logger& logger) {
  logger.Info("listening", {{"grpc_address", config.listen},
                            {"grpc_port", int64_t{server.port()}},
                            {"ops_address", config.ops_listen},
                            {"ops_port", int64_t{server.ops_port()}},
                            {"tls", !config.tls.certificate_file.empty()},
                            {"mutual_tls", !config.tls.client_ca_file.empty()},
                            {"tokens", !config.token_file.empty()},
                            {"data_dir", config.data_dir},
                            {"pid", int64_t{getpid()}},
                            {"build", BuildId()}});
}

ExitStatus ServeUntilSignal(const ServerConfig& config, const std::string& ports_file) {
  signal(SIGPIPE, SIG_IGN);  // a peer that went away is an error of the write
  // Before any thread exists.
  const TerminationSignals signals("curvereg-server: asked to stop again, leaving at once\n");
  KeepFreedMemory();
  google::protobuf::SetLogHandler(nullptr);  // it would print what clients sent, past our log
  absl::StatusOr<std::unique_ptr<Logger>> logger = Logger::Create(config.log, stderr);
  if (!logger.ok()) return Fail(logger.status());
  const GrpcLog grpc_log(**logger);
  RemoveOldPorts(ports_file);
  absl::StatusOr<std::unique_ptr<Server>> server = Server::Start(config);
  if (!server.ok()) return Fail(server.status(), **logger);
  if (const absl::Status status = WritePorts(ports_file, **server); !status.ok()) return Fail(status, **logger);
  LogListening(config, **server, **logger);
  signals.Wait();
  (*logger)->Info("stopping", {{"grace_seconds", int64_t{config.grace_seconds}}});
  (*server)->Shutdown(std::chrono::seconds(config.grace_seconds));
  server->reset();
  (*logger)->Info("stopped");
  return ExitStatus::kDone;
}

ExitStatus Run(const ServeCommand& command) {
  if (command.print_settings) {
    std::fputs(SettingsMarkdown().c_str(), stdout);
    return ExitStatus::kDone;
  }
  const absl::StatusOr<ServerConfig> config =
      ReadConfig({.toml_file = command.config_file, .environment = ServerEnvironment(environ), .flags = command.flags});
  if (!config.ok()) {
    Fail(config.status());
    return ExitStatus::kUsage;  // a file of settings that is not there is a wrong setting, too
  }
  if (command.print_config) {
    std::fputs(ConfigToml(*config).c_str(), stdout);
    return ExitStatus::kDone;
  }
  return ServeUntilSignal(*config, command.ports_file);
}

ExitStatus Run(const MakeTokenCommand& command) {
  const absl::StatusOr<NewToken> token = MakeToken(command.name, command.scope);
  if (!token.ok()) return Fail(token.status());
  if (!command.append_to.empty()) {
    absl::StatusOr<std::string> text = ReadSmallFile(command.append_to);
    if (absl::IsNotFound(text.status())) text = "";
    if (!text.ok()) return Fail(text.status());
    // What is no token file must not become half of one: a server would go on with the tokens that it knows.
    const absl::StatusOr<std::vector<TokenEntry>> entries = ParseTokenFile(*text, command.append_to);
    if (!entries.ok()) return Fail(entries.status());
    if (!text->empty() && text->back() != '\n') *text += "\n";
    const absl::Status status = WriteFileAtomically(command.append_to, *text + token->toml);
    if (!status.ok()) return Fail(status);
  }
  std::printf("%s\n", token->token.c_str());
  if (command.append_to.empty()) std::printf("\n%s", token->toml.c_str());
  return ExitStatus::kDone;
}

ExitStatus ParseAndRun(int argc, char** argv) {
  const ParsedCommandLine parsed = ParseCommandLine(argc, argv);
  if (parsed.is_done) return static_cast<ExitStatus>(parsed.exit_status);
  return std::visit([](const auto& command) { return Run(command); }, parsed.command);
}

// Our code throws nothing; the libraries below it may, above all when memory runs out.
ExitStatus Main(int argc, char** argv) {
  try {
    return ParseAndRun(argc, argv);
  } catch (const std::bad_alloc&) {
    std::fputs("curvereg-server: out of memory\n", stderr);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "curvereg-server: internal error: %s\n", error.what());
  }
  return ExitStatus::kFailed;
}

}  // namespace
}  // namespace curvereg::server

int main(int argc, char** argv) { return static_cast<int>(curvereg::server::Main(argc, argv)); }
