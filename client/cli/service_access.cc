// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/cli/service_access.h"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cstdlib>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "client/cli/argument_parsing.h"
#include "client/cli/progress_bar.h"
#include "client/files/file_bytes.h"

namespace curvereg::cli {
namespace {

// Two scans of this size pass any server's limit on messages; larger ones are better sent so that a cut does not lose
// them.
constexpr std::size_t kMaxInlinePoints = 1'000'000;
constexpr uint64_t kMaxTokenBytes = 4096;

// A token on the command line would be seen by everybody on the machine: file or environment only.
absl::StatusOr<std::string> TokenOf(const ServerArguments& arguments) {
  if (arguments.token_file.empty()) {
    const char* token = std::getenv("CURVEREG_TOKEN");
    return std::string(token == nullptr ? "" : token);
  }
  const absl::StatusOr<FileBytes> bytes = ReadFileBytes(arguments.token_file, kMaxTokenBytes);
  if (!bytes.ok()) return bytes.status();
  return std::string(absl::StripAsciiWhitespace(std::string(bytes->view())));
}

// gRPC would look up "http://..." as a host, and take port 0 where none is given, until the time to connect is over.
absl::Status CheckServer(const std::string& server) {
  const bool is_url = server.rfind("http://", 0) == 0 || server.rfind("https://", 0) == 0;
  if (!is_url && server.find(':') != std::string::npos) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("--server: ", server, ": expected HOST:PORT"));
}

absl::StatusOr<ClientOptions> OptionsOf(const ServerArguments& arguments) {
  const absl::StatusOr<std::string> token = TokenOf(arguments);
  if (!token.ok()) return token.status();
  ClientOptions options;
  options.token = *token;
  options.call_timeout = std::chrono::milliseconds(static_cast<int64_t>(arguments.timeout_s * 1e3));
  options.connect_timeout = std::min(options.connect_timeout, options.call_timeout);
  options.tls = {.enabled = arguments.tls || !arguments.ca.empty() || !arguments.certificate.empty(),
                 .ca_file = arguments.ca,
                 .certificate_file = arguments.certificate,
                 .key_file = arguments.key,
                 .server_name = arguments.server_name};
  return options;
}

}  // namespace

void AddServerOptions(CLI::App& command, ServerArguments& arguments) {
  const std::string group = "Server";
  command.add_option("--server", arguments.server, "Ask this server; without it, or empty, this process does the work")
      ->envname("CURVEREG_SERVER")
      ->type_name("HOST:PORT")
      ->group(group);
  command
      .add_option("--token-file", arguments.token_file, "File with the bearer token; else the variable CURVEREG_TOKEN")
      ->type_name("FILE")
      ->group(group);
  command.add_flag("--tls", arguments.tls, "Encrypt; implied by the next two")->envname("CURVEREG_TLS")->group(group);
  command.add_option("--tls-ca", arguments.ca, "PEM of the authority that signed the server; else the system's")
      ->envname("CURVEREG_TLS_CA")
      ->type_name("FILE")
      ->group(group);
  command.add_option("--tls-cert", arguments.certificate, "PEM certificate of this client, for mutual TLS")
      ->envname("CURVEREG_TLS_CERT")
      ->type_name("FILE")
      ->group(group);
  command.add_option("--tls-key", arguments.key, "PEM key of that certificate")
      ->envname("CURVEREG_TLS_KEY")
      ->type_name("FILE")
      ->group(group);
  command.add_option("--tls-server-name", arguments.server_name, "Name in the server's certificate, if not HOST")
      ->envname("CURVEREG_TLS_SERVER_NAME")
      ->type_name("NAME")
      ->group(group);
  command
      .add_option("--timeout", arguments.timeout_s, "Seconds for a call with its retries; connecting takes at most 10")
      ->check(CheckPositive)
      ->capture_default_str()
      ->group(group);
}

ServiceAccess::~ServiceAccess() {
  if (client_ == nullptr) return;
  for (const std::string& name : temporary_) {
    const absl::Status status = client_->DeleteScan(name);
    if (status.ok()) continue;
    ReportWarning(absl::StrCat(name, ": stays on the server: ", status.message()));
    return;  // one line is enough when the server is gone
  }
}

absl::StatusOr<ServiceAccess> ServiceAccess::Open(const ServerArguments& arguments) {
  return OpenWith(arguments, [] { return server::Server::StartInProcess(server::ServerConfig()); });
}

absl::StatusOr<ServiceAccess> ServiceAccess::OpenWithData(const ServerArguments& arguments,
                                                          const std::string& data_dir) {
  return OpenWith(arguments, [&data_dir] {
    server::ServerConfig config;
    config.listen = "127.0.0.1:0";  // nobody is told the port
    config.ops_listen.clear();
    config.data_dir = data_dir;
    config.log.level = "error";
    config.drain_delay_ms = 0;
    auto started = server::Server::Start(config);
    if (!absl::IsUnavailable(started.status())) return started;
    return decltype(started)(absl::FailedPreconditionError(absl::StrCat("--data-dir: ", started.status().message())));
  });
}

absl::StatusOr<ServiceAccess> ServiceAccess::OpenWith(const ServerArguments& arguments, const StartLocal& start_local) {
  ServiceAccess service;
  const absl::StatusOr<ClientOptions> options = OptionsOf(arguments);
  if (!options.ok()) return options.status();
  if (!arguments.server.empty()) {
    if (absl::Status status = CheckServer(arguments.server); !status.ok()) return status;
    absl::StatusOr<std::unique_ptr<Client>> client = Client::Connect(arguments.server, *options);
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

bool IsScanName(const std::string& argument) {
  constexpr std::size_t kDigits = 32;
  const std::string prefix = "scans/";
  return argument.size() == prefix.size() + kDigits && argument.compare(0, prefix.size(), prefix) == 0 &&
         argument.find_first_not_of("0123456789abcdef", prefix.size()) == std::string::npos;
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
