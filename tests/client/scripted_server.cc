// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/client/scripted_server.h"

#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>

#include <chrono>
#include <optional>
#include <utility>

#include "tests/testing/scenes.h"
#include "wire/error.h"
#include "wire/status_mapping.h"

namespace curvereg::testing {
namespace {

namespace health = grpc::health::v1;

template <typename Function, typename... Arguments>
grpc::Status Play(const Function& function, Arguments&&... arguments) {
  if (!function) return {grpc::UNIMPLEMENTED, "not in the script"};
  return function(std::forward<Arguments>(arguments)...);
}

class Registration final : public v1::RegistrationService::Service {
 public:
  explicit Registration(const Script& script) : script_(script) {}
  grpc::Status RegisterScans(grpc::ServerContext* context, const v1::RegisterScansRequest* request,
                             v1::RegisterScansResponse* response) override {
    return Play(script_.register_scans, *context, *request, *response);
  }
  grpc::Status ListMethods(grpc::ServerContext* context, const v1::ListMethodsRequest* request,
                           v1::ListMethodsResponse* response) override {
    return Play(script_.list_methods, *context, *request, *response);
  }
  grpc::Status RenderScan(grpc::ServerContext* context, const v1::RenderScanRequest* request,
                          v1::RenderScanResponse* response) override {
    return Play(script_.render_scan, *context, *request, *response);
  }

 private:
  const Script& script_;
};

class Scans final : public v1::ScanService::Service {
 public:
  explicit Scans(const Script& script) : script_(script) {}
  grpc::Status UploadScan(grpc::ServerContext* context, Script::UploadStream* stream) override {
    return Play(script_.upload_scan, *context, *stream);
  }
  grpc::Status DownloadScan(grpc::ServerContext* context, const v1::DownloadScanRequest* request,
                            Script::DownloadWriter* writer) override {
    return Play(script_.download_scan, *context, *request, *writer);
  }
  grpc::Status GetScan(grpc::ServerContext* context, const v1::GetScanRequest* request,
                       v1::GetScanResponse* response) override {
    return Play(script_.get_scan, *context, *request, *response);
  }
  grpc::Status ListScans(grpc::ServerContext* context, const v1::ListScansRequest* request,
                         v1::ListScansResponse* response) override {
    return Play(script_.list_scans, *context, *request, *response);
  }
  grpc::Status DeleteScan(grpc::ServerContext* context, const v1::DeleteScanRequest* request,
                          v1::DeleteScanResponse* response) override {
    return Play(script_.delete_scan, *context, *request, *response);
  }

 private:
  const Script& script_;
};

class Health final : public health::Health::Service {
 public:
  explicit Health(const Script& script) : script_(script) {}
  grpc::Status Check(grpc::ServerContext* context, const health::HealthCheckRequest* request,
                     health::HealthCheckResponse* response) override {
    return Play(script_.check, *context, *request, *response);
  }

 private:
  const Script& script_;
};

}  // namespace

struct ScriptedServer::Services {
  explicit Services(Script the_script) : script(std::move(the_script)) {}
  const Script script;
  Registration registration{script};
  Scans scans{script};
  Health health{script};
  int port = 0;
  std::unique_ptr<grpc::Server> server;
};

ScriptedServer::ScriptedServer(Script script, int port, const grpc::ResourceQuota* quota)
    : services_(std::make_unique<Services>(std::move(script))) {
  grpc::ServerBuilder builder;
  builder.AddListeningPort("127.0.0.1:" + std::to_string(port), grpc::InsecureServerCredentials(), &services_->port);
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, 100);
  builder.SetMaxReceiveMessageSize(64 << 20);
  if (quota != nullptr) builder.SetResourceQuota(*quota);
  builder.RegisterService(&services_->registration);
  builder.RegisterService(&services_->scans);
  builder.RegisterService(&services_->health);
  services_->server = builder.BuildAndStart();
  EXPECT_NE(services_->server, nullptr);
}

ScriptedServer::~ScriptedServer() {
  if (services_->server != nullptr) services_->server->Shutdown(std::chrono::system_clock::now());
}

int ScriptedServer::port() const { return services_->port; }

grpc::Status Refusal(v1::ErrorReason reason, std::chrono::milliseconds delay) {
  const absl::Status error = wire::MakeError(reason, "refused");
  return wire::ToGrpcStatus(delay.count() > 0 ? wire::WithRetryDelay(error, delay) : error, "request-1");
}

Scan StrewnScan(int num_points) { return {PatchPoints({.noise_m = 0.1}, num_points, 3), std::nullopt}; }

ClientOptions QuickOptions() {
  ClientOptions options;
  options.connect_timeout = std::chrono::milliseconds(3000);
  options.call_timeout = std::chrono::milliseconds(10'000);
  options.retry.initial_backoff = std::chrono::milliseconds(10);
  options.retry.max_backoff = std::chrono::milliseconds(40);
  return options;
}

std::unique_ptr<Client> ConnectTo(const std::string& target, const ClientOptions& options) {
  absl::StatusOr<std::unique_ptr<Client>> client = Client::Connect(target, options);
  EXPECT_TRUE(client.ok()) << client.status();
  return client.ok() ? *std::move(client) : nullptr;
}

}  // namespace curvereg::testing
