// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The one warm channel of a client, and its replacement when it does not come back.
#ifndef CURVEREG_CLIENT_CONNECTION_H_
#define CURVEREG_CLIENT_CONNECTION_H_

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/security/credentials.h>

#include <chrono>
#include <memory>
#include <mutex>
#include <random>
#include <string>

#include "absl/status/statusor.h"
#include "client/client.h"
#include "core/base/stop.h"

namespace curvereg::internal {

// Safe to use from several threads.
class Connection {
 public:
  // Makes the channel; AwaitReady connects it. INVALID_ARGUMENT as ValidateOptions and MakeCredentials.
  static absl::StatusOr<std::unique_ptr<Connection>> Open(const std::string& target, const ClientOptions& options);
  static std::unique_ptr<Connection> Over(std::shared_ptr<grpc::Channel> channel, const ClientOptions& options);

  const ClientOptions& options() const { return options_; }
  const std::string& target() const { return target_; }  // empty: the channel was given
  std::shared_ptr<grpc::Channel> channel() const;

  // Until there is a connection. A channel that stays without one for long is made anew: name resolution and sockets
  // can be stuck in ways that gRPC does not notice. CANCELLED, or UNAVAILABLE when the deadline of `until` passes.
  // A channel given to Over() is always taken for ready.
  absl::Status AwaitReady(const Stop& until);

  // What every call carries: the bearer token.
  void Prepare(grpc::ClientContext& context) const;

  // Evenly from [0, 1), another sequence in every client: clients that failed together shall not come back together.
  double Jitter();

 private:
  Connection(std::string target, const ClientOptions& options);
  std::shared_ptr<grpc::Channel> MakeChannel() const;
  // Replaces `old`, unless somebody else has done so.
  void Rebuild(const std::shared_ptr<grpc::Channel>& old);

  const std::string target_;  // empty: the channel is the caller's
  const ClientOptions options_;
  std::shared_ptr<grpc::ChannelCredentials> credentials_;
  mutable std::mutex mutex_;
  std::shared_ptr<grpc::Channel> channel_;  // guarded by mutex_
  std::mt19937_64 random_;                  // guarded by mutex_
};

}  // namespace curvereg::internal

#endif  // CURVEREG_CLIENT_CONNECTION_H_
