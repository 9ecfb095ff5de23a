// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A real gRPC server on loopback whose answers a test writes: for errors that a sound server gives seldom, and for
// answers that it never gives.
#ifndef CURVEREG_TESTS_CLIENT_SCRIPTED_SERVER_H_
#define CURVEREG_TESTS_CLIENT_SCRIPTED_SERVER_H_

#include <grpcpp/resource_quota.h>
#include <grpcpp/server.h>

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "client/client.h"
#include "core/scan/scan.h"
#include "curvereg/v1/error_reason.pb.h"
#include "curvereg/v1/registration_service.grpc.pb.h"
#include "curvereg/v1/scan_service.grpc.pb.h"
#include "grpc/health/v1/health.grpc.pb.h"

namespace curvereg::testing {

// What the methods do; a method without a script is UNIMPLEMENTED.
struct Script {
  template <typename Request, typename Response>
  using Unary = std::function<grpc::Status(grpc::ServerContext&, const Request&, Response&)>;
  using UploadStream = grpc::ServerReaderWriter<v1::UploadScanResponse, v1::UploadScanRequest>;
  using DownloadWriter = grpc::ServerWriter<v1::DownloadScanResponse>;

  Unary<v1::RegisterScansRequest, v1::RegisterScansResponse> register_scans;
  Unary<v1::ListMethodsRequest, v1::ListMethodsResponse> list_methods;
  Unary<v1::RenderScanRequest, v1::RenderScanResponse> render_scan;
  Unary<v1::GetScanRequest, v1::GetScanResponse> get_scan;
  Unary<v1::ListScansRequest, v1::ListScansResponse> list_scans;
  Unary<v1::DeleteScanRequest, v1::DeleteScanResponse> delete_scan;
  Unary<grpc::health::v1::HealthCheckRequest, grpc::health::v1::HealthCheckResponse> check;
  std::function<grpc::Status(grpc::ServerContext&, UploadStream&)> upload_scan;
  std::function<grpc::Status(grpc::ServerContext&, const v1::DownloadScanRequest&, DownloadWriter&)> download_scan;
};

class ScriptedServer {
 public:
  // Port 0 takes a free one. The script is run by several threads at once. gRPC keeps to `quota`, if there is one.
  explicit ScriptedServer(Script script, int port = 0, const grpc::ResourceQuota* quota = nullptr);
  ~ScriptedServer();
  int port() const;
  std::string target() const { return "127.0.0.1:" + std::to_string(port()); }

 private:
  struct Services;
  std::unique_ptr<Services> services_;
};

// An error as a server of ours gives it, with a RetryInfo when `delay` is above 0.
grpc::Status Refusal(v1::ErrorReason reason, std::chrono::milliseconds delay = std::chrono::milliseconds(0));

// Points strewn about a square metre.
Scan StrewnScan(int num_points = 20'000);

// Short times, so that tests are quick.
ClientOptions QuickOptions();

// A client of the server; failure of the test when there is none.
std::unique_ptr<Client> ConnectTo(const std::string& target, const ClientOptions& options = QuickOptions());

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_CLIENT_SCRIPTED_SERVER_H_
