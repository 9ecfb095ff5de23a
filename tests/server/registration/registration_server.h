// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A RegistrationService alone on a port of the loopback interface, with a real store, and scans for it.
#ifndef CURVEREG_TESTS_SERVER_REGISTRATION_REGISTRATION_SERVER_H_
#define CURVEREG_TESTS_SERVER_REGISTRATION_REGISTRATION_SERVER_H_

#include <grpcpp/grpcpp.h>

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "absl/status/statusor.h"
#include "core/register_scans.h"
#include "curvereg/v1/registration_service.grpc.pb.h"
#include "server/access/access.h"
#include "server/registration/registration_service.h"
#include "tests/testing/scenes.h"
#include "tests/testing/test_data.h"
#include "wire/digest.h"
#include "wire/error.h"
#include "wire/point_codec.h"
#include "wire/status_mapping.h"

namespace curvereg::testing {

struct RegistrationServerOptions {
  server::LimitsConfig limits = {.max_concurrent_registrations = 1, .max_threads_per_registration = 2};
  uint64_t memory_bytes = uint64_t{2} << 30;
  const server::Access* access = nullptr;  // null: open
  server::ScanStore* store = nullptr;      // null: a new one in a temporary folder
  bool has_store = true;
};

class RegistrationServer {
 public:
  using Options = RegistrationServerOptions;

  explicit RegistrationServer(const Options& options = {})
      : memory(options.memory_bytes),
        cache(uint64_t{256} << 20),
        pool({.num_workers = options.limits.max_concurrent_registrations,
              .max_queue_length = options.limits.max_queue_length,
              .max_queue_per_client = options.limits.max_queue_per_client}) {
    if (options.has_store && options.store == nullptr) own_store_ = *server::ScanStore::Open(folder_.path(), {});
    server::RegistrationBackend backend;
    backend.calls.access = options.access != nullptr ? options.access : open_access_.get();
    backend.calls.metrics = &metrics;
    backend.calls.draining = draining.get_token();
    backend.calls.ending = ending.get_token();
    backend.scans = {.limits = options.limits,
                     .memory = &memory,
                     .cache = &cache,
                     .store = options.store != nullptr ? options.store : own_store_.get(),
                     .metrics = &metrics};
    backend.pool = &pool;
    service_ = std::make_unique<server::RegistrationService>(backend);
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port_);
    builder.SetMaxReceiveMessageSize(static_cast<int>(options.limits.max_message_bytes));
    builder.RegisterService(service_.get());
    server_ = builder.BuildAndStart();
    grpc::ChannelArguments arguments;
    arguments.SetMaxReceiveMessageSize(64 << 20);
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    stub = v1::RegistrationService::NewStub(
        grpc::CreateCustomChannel("127.0.0.1:" + std::to_string(port_), grpc::InsecureChannelCredentials(), arguments));
  }

  ~RegistrationServer() {
    server_->Shutdown(std::chrono::system_clock::now());
    pool.Shutdown(std::chrono::steady_clock::now() + std::chrono::seconds(20));
  }

  absl::StatusOr<v1::RegisterScansResponse> Register(const v1::RegisterScansRequest& request) {
    grpc::ClientContext context;
    return Register(request, context);
  }
  absl::StatusOr<v1::RegisterScansResponse> Register(const v1::RegisterScansRequest& request,
                                                     grpc::ClientContext& context) {
    v1::RegisterScansResponse response;
    const grpc::Status status = stub->RegisterScans(&context, request, &response);
    if (!status.ok()) return wire::FromGrpcStatus(status);
    return response;
  }
  absl::StatusOr<v1::RenderScanResponse> Render(const v1::RenderScanRequest& request) {
    grpc::ClientContext context;
    v1::RenderScanResponse response;
    const grpc::Status status = stub->RenderScan(&context, request, &response);
    if (!status.ok()) return wire::FromGrpcStatus(status);
    return response;
  }

  // Puts the cloud into the store; its resource name.
  std::string Store(const v1::PointCloud& cloud) {
    const Scan scan = *wire::DecodeScan(cloud.header(), cloud.data(), {});
    auto writer = own_store_->BeginUpload(
        {.id = "upload", .header = cloud.header(), .payload_bytes = cloud.data().size(), .payload_digest = {}});
    if (!writer.ok() || !(*writer)->Append(0, cloud.data()).ok()) return "";
    const auto committed = (*writer)->Commit(scan.points.size(), ScanDigest(scan));
    return committed.ok() ? "scans/" + committed->scan.id : "";
  }

  server::ScanStore& store() { return *own_store_; }

  server::Metrics metrics;
  std::stop_source draining;
  std::stop_source ending;
  server::MemoryBudget memory;
  server::PreparedScanCache cache;
  server::WorkerPool pool;
  std::unique_ptr<v1::RegistrationService::Stub> stub;

 private:
  TemporaryFolder folder_;
  std::unique_ptr<server::Access> open_access_ = server::Access::Open();
  std::unique_ptr<server::ScanStore> own_store_;
  std::unique_ptr<server::RegistrationService> service_;
  std::unique_ptr<grpc::Server> server_;
  int port_ = 0;
};

// Asks every millisecond; false when it stays untrue for 20 s.
template <typename Condition>
bool BecomesTrue(const Condition& condition) {
  for (int i = 0; i < 20'000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return condition();
}

// A scan of the bumpy ground from (x, y), and what it is in a message.
inline Scan GroundScan(double x, double y, double yaw_rad, uint64_t seed, uint64_t world_seed = 1) {
  return BumpyGround(RoverPose(x, y, yaw_rad, 1.6, world_seed), {.noise_seed = seed, .world_seed = world_seed});
}
inline const Scan& SourceScan() {
  static const Scan scan = GroundScan(3.0, 1.0, 0.4, 1);
  return scan;
}
inline const Scan& TargetScan() {
  static const Scan scan = GroundScan(0.0, 0.0, 0.0, 2);
  return scan;
}
inline RigidTransform TrueTransform() { return RoverPose(0.0, 0.0, 0.0).inverse() * RoverPose(3.0, 1.0, 0.4); }
// Of another world than the target: nothing fits, so that every escalation step runs.
inline const Scan& StrangeScan() {
  static const Scan scan = GroundScan(1.0, 2.0, 0.5, 1, 2);
  return scan;
}

inline v1::PointCloud CloudOf(const Scan& scan) { return *wire::EncodeScan(scan); }

inline v1::RegisterScansRequest InlineRequest(const Scan& source, const Scan& target) {
  v1::RegisterScansRequest request;
  *request.mutable_source()->mutable_inline_scan() = CloudOf(source);
  *request.mutable_target()->mutable_inline_scan() = CloudOf(target);
  return request;
}

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_SERVER_REGISTRATION_REGISTRATION_SERVER_H_
