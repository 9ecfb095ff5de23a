// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The operations port, HTTP/1.1 without TLS: GET and HEAD of /metrics, /livez and /readyz, nothing else. For scrapers
// and orchestrators; loopback unless the settings say otherwise.
#ifndef CURVEREG_SERVER_OPERATIONS_OPS_SERVER_H_
#define CURVEREG_SERVER_OPERATIONS_OPS_SERVER_H_

#include <functional>
#include <memory>
#include <string>

#include "absl/status/statusor.h"

namespace curvereg::server {

struct OpsSources {
  std::function<std::string()> metrics;    // Prometheus text; called on the port's threads
  std::function<std::string()> not_ready;  // empty: ready; else the reason, which /readyz answers with 503
};

class OpsServer {
 public:
  // `listen`: HOST:PORT, host a numeric address, "localhost", or empty for all addresses; port 0 takes a free one.
  // INVALID_ARGUMENT: malformed; UNAVAILABLE: cannot be listened on.
  static absl::StatusOr<std::unique_ptr<OpsServer>> Start(const std::string& listen, const OpsSources& sources);
  ~OpsServer();  // closes the port, after the answers under way
  OpsServer(const OpsServer&) = delete;
  OpsServer& operator=(const OpsServer&) = delete;

  int port() const;  // bound

 private:
  struct State;
  explicit OpsServer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_OPERATIONS_OPS_SERVER_H_
