// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A whole server: store, pools, services, ports. Used by curvereg-server, by the command line without --server (in its
// own process, over gRPC's in-process channel) and by tests.
#ifndef CURVEREG_SERVER_SERVER_H_
#define CURVEREG_SERVER_SERVER_H_

#include <grpcpp/channel.h>

#include <chrono>
#include <memory>

#include "absl/status/statusor.h"
#include "server/settings/server_config.h"

namespace curvereg::server {

class Server {
 public:
  // Opens the store, warms up (plans FFTs, one registration), listens, then is ready. INVALID_ARGUMENT: settings (see
  // Validate), or files that they name; UNAVAILABLE: an address that cannot be listened on; errors of ScanStore::Open.
  static absl::StatusOr<std::unique_ptr<Server>> Start(const ServerConfig& config);

  // The same on no port at all, for InProcessChannel(): the settings of ports, TLS and tokens do not count.
  static absl::StatusOr<std::unique_ptr<Server>> StartWithoutPort(const ServerConfig& config);

  // The same services on no port either, without a store or an operations port, for InProcessChannel(): scans are
  // given inline, limits are those of memory alone, and nothing is warmed up.
  static absl::StatusOr<std::unique_ptr<Server>> StartInProcess(const ServerConfig& config);

  virtual ~Server() = default;  // Shutdown with no grace

  virtual int port() const = 0;      // bound port of gRPC; 0 in process
  virtual int ops_port() const = 0;  // bound port of operations; 0 when there is none
  virtual std::shared_ptr<grpc::Channel> InProcessChannel() = 0;

  // Not ready at once; after drain_delay refuses new calls (NOT_SERVING); running calls finish until `grace` is over,
  // then they end with NOT_SERVING. Returns when all is done. Idempotent.
  virtual void Shutdown(std::chrono::milliseconds grace) = 0;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_SERVER_H_
