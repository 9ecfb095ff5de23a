// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/service_access.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <stop_token>
#include <thread>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "cli/argument_parsing.h"
#include "cli/progress_bar.h"
#include "cli/scan_folder.h"
#include "files/file_bytes.h"
#include "program/command_syntax.h"
#include "wire/listen_address.h"

namespace curvereg::cli {
namespace {

// Two scans of this size pass any server's limit on messages; larger ones are better sent so that a cut does not lose
// them.
constexpr std::size_t kMaxInlinePoints = 1'000'000;
constexpr uint64_t kMaxTokenBytes = 4096;
constexpr std::chrono::seconds kQuietWait(1);    // for a connection, before a notice is printed
constexpr std::chrono::seconds kCleanUpTime(3);  // for each scan to delete; limits the wait for a server that is gone

// Every user of the machine could see a token on the command line: file or environment only.
absl::StatusOr<std::string> TokenOf(const ServerArguments& arguments) {
  if (arguments.token_file.empty()) {
    const char* token = std::getenv("CURVEREG_TOKEN");
    return std::string(token == nullptr ? "" : token);
  }
  const absl::StatusOr<FileBytes> bytes = ReadFileBytes(arguments.token_file, kMaxTokenBytes);
  if (!bytes.ok()) return absl::Status(bytes.status().code(), absl::StrCat("--token-file: ", bytes.status().message()));
  std::string token(absl::StripAsciiWhitespace(std::string(bytes->view())));
  if (!token.empty()) return token;
  return absl::InvalidArgumentError(absl::StrCat("--token-file: ", arguments.token_file, ": contains no token"));
}

// gRPC itself takes a port modulo 65536, a port that is not a number as 0, and "http://..." as a host.
absl::Status CheckServer(const std::string& server) {
  for (const char* scheme : {"dns:", "ipv4:", "ipv6:", "unix:", "unix-abstract:"}) {
    if (absl::StartsWith(server, scheme)) return absl::OkStatus();  // a gRPC name, which gRPC checks
  }
  const absl::StatusOr<wire::ListenAddress> address = wire::ParseListenAddress(server);
  if (address.ok() && address->port != 0 && !absl::StrContains(server, '/')) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("--server: ", server, ": expected HOST:PORT, the port from 1 to 65535, IPv6 addresses in brackets"));
}

// Prints a notice if connecting takes long.
class WaitNotice {
 public:
  explicit WaitNotice(const std::string& server)
      : thread_([server](const std::stop_token& over) {
          SleepOrStop(kQuietWait, over);
          if (over.stop_requested()) return;
          std::fprintf(stderr, "curvereg: waiting for %s, which has not answered yet\n", server.c_str());
        }) {}

 private:
  std::jthread thread_;
};

// A server that requires TLS, or a certificate, closes other connections, and gRPC reports only that.
absl::Status WithAdvice(const absl::Status& error, const TlsOptions& tls) {
  const char* advice = "";
  if (absl::StrContains(error.message(), "Socket closed")) {
    if (!tls.enabled) advice = "; if the server uses TLS, give --tls or --tls-ca";
    if (tls.enabled && tls.certificate_file.empty()) {
      advice = "; if the server requires a certificate, give --tls-cert and --tls-key";
    }
  } else if (absl::StrContains(error.message(), "wrong version number")) {
    advice = "; if the server uses plain text, omit --tls, --tls-ca and --tls-cert";
  }
  return absl::Status(error.code(), absl::StrCat(error.message(), advice));
}

absl::StatusOr<std::unique_ptr<Client>> Connect(const std::string& server, const ClientOptions& options,
                                                const CliContext& context) {
  if (absl::Status status = CheckServer(server); !status.ok()) return status;
  const WaitNotice notice(server);
  absl::StatusOr<std::unique_ptr<Client>> client = Client::Connect(server, options, context.interrupted);
  if (absl::IsUnavailable(client.status())) return WithAdvice(client.status(), options.tls);
  return client;
}

absl::StatusOr<ClientOptions> OptionsOf(const ServerArguments& arguments) {
  const absl::StatusOr<std::string> token = TokenOf(arguments);
  if (!token.ok()) return token.status();
  ClientOptions options;
  options.token = *token;
  options.call_timeout = std::chrono::milliseconds(static_cast<int64_t>(std::ceil(arguments.timeout_s * 1e3)));
  options.connect_timeout = std::min(options.connect_timeout, options.call_timeout);
  options.tls = {.enabled = arguments.tls || !arguments.ca.empty() || !arguments.certificate.empty(),
                 .ca_file = arguments.ca,
                 .certificate_file = arguments.certificate,
                 .key_file = arguments.key,
                 .server_name = arguments.server_name};
  return options;
}

}  // namespace

void AddServerOptions(CommandSyntax command, ServerArguments& arguments) {
  const std::string group = "Server";
  command
      .AddOption("--server", arguments.server, "Use this server; without it, or if empty, this process does the work")
      .Environment("CURVEREG_SERVER")
      .ValueName("HOST:PORT")
      .Group(group);
  command
      .AddOption("--token-file", arguments.token_file,
                 "File with the bearer token; default: the variable CURVEREG_TOKEN")
      .ValueName("FILE")
      .Group(group);
  command.AddFlag("--tls", arguments.tls, "Use TLS; implied by --tls-ca and --tls-cert")
      .Environment("CURVEREG_TLS")
      .Group(group);
  command
      .AddOption("--tls-ca", arguments.ca, "PEM file of the certificate authority of the server; default: the system's")
      .Environment("CURVEREG_TLS_CA")
      .ValueName("FILE")
      .Group(group);
  command.AddOption("--tls-cert", arguments.certificate, "PEM file of the certificate of this client, for mutual TLS")
      .Environment("CURVEREG_TLS_CERT")
      .ValueName("FILE")
      .Group(group);
  command.AddOption("--tls-key", arguments.key, "PEM file of the private key of that certificate")
      .Environment("CURVEREG_TLS_KEY")
      .ValueName("FILE")
      .Group(group);
  command.AddOption("--tls-server-name", arguments.server_name, "Name in the server's certificate, if not HOST")
      .Environment("CURVEREG_TLS_SERVER_NAME")
      .ValueName("NAME")
      .Group(group);
  command
      .AddOption("--timeout", arguments.timeout_s, "Seconds for a call with its retries; connecting takes at most 10")
      .Check(CheckSeconds)
      .ShowDefault()
      .Group(group);
}

ServiceAccess::~ServiceAccess() {
  if (client_ == nullptr) return;
  for (const std::string& name : temporary_) {
    const absl::Status status = client_->DeleteScan(name, {{}, std::chrono::steady_clock::now() + kCleanUpTime});
    if (status.ok()) continue;
    ReportWarning(absl::StrCat(name, ": not deleted from the server: ", status.message()));
    return;  // one line is enough when the server is gone
  }
}

absl::StatusOr<ServiceAccess> ServiceAccess::Open(const ServerArguments& arguments, const CliContext& context) {
  return OpenWith(
      arguments, [] { return server::Server::StartInProcess(server::ServerConfig()); }, context);
}

absl::StatusOr<ServiceAccess> ServiceAccess::OpenWithData(const ServerArguments& arguments, const std::string& data_dir,
                                                          const CliContext& context) {
  const auto start_local = [&data_dir] {
    server::ServerConfig config;
    config.data_dir = data_dir;
    config.log.level = "error";
    config.drain_delay_ms = 0;
    auto started = server::Server::StartWithoutPort(config);
    if (!absl::IsUnavailable(started.status())) return started;
    return decltype(started)(absl::FailedPreconditionError(absl::StrCat("--data-dir: ", started.status().message())));
  };
  return OpenWith(arguments, start_local, context);
}

absl::StatusOr<ServiceAccess> ServiceAccess::OpenWith(const ServerArguments& arguments, const StartLocal& start_local,
                                                      const CliContext& context) {
  ServiceAccess service;
  const absl::StatusOr<ClientOptions> options = OptionsOf(arguments);
  if (!options.ok()) return options.status();
  if (!arguments.server.empty()) {
    absl::StatusOr<std::unique_ptr<Client>> client = Connect(arguments.server, *options, context);
    if (!client.ok()) return client.status();
    service.client_ = *std::move(client);
    return service;
  }
  absl::StatusOr<std::unique_ptr<server::Server>> local = start_local();
  if (!local.ok()) return local.status();
  service.local_ = *std::move(local);
  // Nobody waits for this process but its user, who can interrupt it.
  ClientOptions patient = *options;
  patient.call_timeout = std::chrono::hours(24 * 30);
  service.client_ = Client::OverChannel(service.local_->InProcessChannel(), patient);
  return service;
}

TransferOptions LosslessTransfer(const CliContext& context) {
  TransferOptions options;
  options.encoding.kind = TransferEncoding::Kind::kLossless;
  options.cancellation = context.interrupted;
  return options;
}

absl::StatusOr<ScanReference> OfferScan(ServiceAccess& service, const Scan& scan, const CliContext& context) {
  if (!service.is_remote() || scan.points.size() <= kMaxInlinePoints) return ScanReference(std::cref(scan));
  ProgressBar bar("uploading");
  TransferOptions options = LosslessTransfer(context);
  options.progress = [&](const TransferProgress& progress) {
    bar.Update(static_cast<double>(progress.bytes_done) / static_cast<double>(progress.bytes_total), "");
  };
  const absl::StatusOr<UploadOutcome> outcome = service.client().UploadScan(scan, options);
  if (!outcome.ok()) return outcome.status();
  if (!outcome->already_stored) service.DeleteAtEnd(outcome->scan.name);
  return ScanReference(outcome->scan.name);
}

}  // namespace curvereg::cli
