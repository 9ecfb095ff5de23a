// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// grpc.health.v1.Health, compiled here: gRPC's built-in one is listed by reflection but cannot be resolved through it.
// Do not enable the built-in one beside it.
#ifndef CURVEREG_SERVER_OPERATIONS_HEALTH_SERVICE_H_
#define CURVEREG_SERVER_OPERATIONS_HEALTH_SERVICE_H_

#include <memory>
#include <string>

#include "grpc/health/v1/health.grpc.pb.h"

namespace curvereg::server {

class HealthService final : public grpc::health::v1::Health::CallbackService {
 public:
  HealthService();
  ~HealthService() override;  // after the grpc::Server's: its streams must have ended

  // Names a service or changes its status; "" is the server as a whole. Watchers are told. Safe from any thread.
  void SetServing(const std::string& service, bool serving);
  // From now on every named service is NOT_SERVING, whatever SetServing says. Watchers are told; idempotent.
  void Drain();
  // Ends all watches with UNAVAILABLE, those that come later at once. Before grpc::Server::Shutdown, which waits for
  // open streams until its deadline.
  void EndWatches();

  // NOT_FOUND for a service that was never named.
  grpc::ServerUnaryReactor* Check(grpc::CallbackServerContext* context,
                                  const grpc::health::v1::HealthCheckRequest* request,
                                  grpc::health::v1::HealthCheckResponse* response) override;
  grpc::ServerWriteReactor<grpc::health::v1::HealthCheckResponse>* Watch(
      grpc::CallbackServerContext* context, const grpc::health::v1::HealthCheckRequest* request) override;

 private:
  struct State;
  class Watcher;
  std::shared_ptr<State> state_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_OPERATIONS_HEALTH_SERVICE_H_
