// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The service that a command speaks to: a server named by --server, or else the same service in this process.
#ifndef CURVEREG_CLI_SERVICE_ACCESS_H_
#define CURVEREG_CLI_SERVICE_ACCESS_H_

#include <functional>
#include <memory>
#include <set>
#include <string>

#include "absl/status/statusor.h"
#include "cli/cli_context.h"
#include "client/client.h"
#include "program/command_syntax.h"
#include "server/server.h"

namespace curvereg::cli {

// As typed, or from the environment.
struct ServerArguments {
  std::string server;  // HOST:PORT; empty: in this process
  std::string token_file;
  bool tls = false;
  std::string ca, certificate, key, server_name;
  double timeout_s = 120.0;
};

// Declares --server (CURVEREG_SERVER), --token-file (or CURVEREG_TOKEN), --tls, --tls-ca, --tls-cert, --tls-key,
// --tls-server-name, --timeout. `arguments` must outlive the app.
void AddServerOptions(CommandSyntax command, ServerArguments& arguments);

class ServiceAccess {
 public:
  // INVALID_ARGUMENT: arguments; UNAVAILABLE: no server answers there; CANCELLED: interrupted. Says on standard error
  // when that takes long.
  static absl::StatusOr<ServiceAccess> Open(const ServerArguments& arguments, const CliContext& context);
  // The same, but the service in this process keeps scans and traverses in the folder. Errors of Server::Start,
  // but FAILED_PRECONDITION in place of UNAVAILABLE: it is the folder that cannot be used.
  static absl::StatusOr<ServiceAccess> OpenWithData(const ServerArguments& arguments, const std::string& data_dir,
                                                    const CliContext& context);

  ServiceAccess() = default;
  ServiceAccess(ServiceAccess&&) = default;
  ServiceAccess& operator=(ServiceAccess&&) = delete;
  ~ServiceAccess();  // deletes what DeleteAtEnd named; warns where that does not succeed soon

  Client& client() { return *client_; }
  bool is_remote() const { return local_ == nullptr; }
  // For scans that were stored for this command alone.
  void DeleteAtEnd(const std::string& name) { temporary_.insert(name); }

 private:
  using StartLocal = std::function<absl::StatusOr<std::unique_ptr<server::Server>>()>;
  static absl::StatusOr<ServiceAccess> OpenWith(const ServerArguments& arguments, const StartLocal& start_local,
                                                const CliContext& context);

  std::unique_ptr<server::Server> local_;  // outlives the client
  std::unique_ptr<Client> client_;
  std::set<std::string> temporary_;
};

// A scan as the service takes it: itself where it fits into a message, else the name under which it was uploaded
// until the end of `service` (lossless, with a progress bar). Keeps a reference to `scan`. Errors of
// Client::UploadScan.
absl::StatusOr<ScanReference> OfferScan(ServiceAccess& service, const Scan& scan, const CliContext& context);

// A transfer without loss and without a progress bar.
TransferOptions LosslessTransfer(const CliContext& context);

// How inline scans are sent: without loss, so that a server answers what this process would.
inline constexpr TransferEncoding kInlineEncoding{.kind = TransferEncoding::Kind::kRaw};

}  // namespace curvereg::cli

#endif  // CURVEREG_CLI_SERVICE_ACCESS_H_
