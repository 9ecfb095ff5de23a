// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/server.h"

#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/resource_quota.h>
#include <grpcpp/server_builder.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/register_scans.h"
#include "server/access/access.h"
#include "server/access/credentials.h"
#include "server/maps/map_builder.h"
#include "server/operations/health_service.h"
#include "server/operations/logging.h"
#include "server/operations/metrics.h"
#include "server/operations/ops_server.h"
#include "server/preparation/prepared_scan_cache.h"
#include "server/registration/registration_service.h"
#include "server/scans/scan_service.h"
#include "server/scheduling/memory_budget.h"
#include "server/scheduling/worker_pool.h"
#include "server/server_gauges.h"
#include "server/settings/resolved_limits.h"
#include "server/store/recovery_log.h"
#include "server/store/scan_store.h"
#include "server/traverses/traverse_service.h"
#include "server/traverses/traverses.h"
#include "server/warm_up.h"
#include "wire/resource_names.h"

namespace curvereg::server {
namespace {

constexpr const char* kRegistrationServiceName = v1::RegistrationService::service_full_name();
constexpr const char* kScanServiceName = v1::ScanService::service_full_name();
constexpr const char* kTraverseServiceName = v1::TraverseService::service_full_name();
constexpr int kDiskWorkers = 2;                             // one that writes, one that checks
constexpr int kMaxDiskTasks = 1 << 20;                      // each open stream has at most one
constexpr uint64_t kLeastQuotaBytes = uint64_t{256} << 20;  // of gRPC's own buffers
constexpr std::chrono::minutes kExpiryInterval{10};         // between looks for abandoned uploads
constexpr std::chrono::milliseconds kEndingMargin{500};     // of the grace time, for calls to end that are stopped
constexpr std::chrono::milliseconds kDrainPoll{5};          // between looks whether calls are open
constexpr std::chrono::milliseconds kFlushTime{100};        // for the last answers to leave

class ServerImpl final : public Server {
 public:
  explicit ServerImpl(const ServerConfig& config)
      : config_(config),
        limits_(ResolveLimits(config.limits)),
        memory_(limits_.memory_bytes),
        cache_(limits_.cache_bytes),
        pool_({.num_workers = limits_.max_concurrent_registrations,
               .max_queue_length = limits_.max_queue_length,
               .max_queue_per_client = limits_.max_queue_per_client}),
        disk_pool_(
            {.num_workers = kDiskWorkers, .max_queue_length = kMaxDiskTasks, .max_queue_per_client = kMaxDiskTasks}) {}
  ~ServerImpl() override { Shutdown(std::chrono::milliseconds(0)); }

  absl::Status Open();
  absl::Status OpenInProcess();

  int port() const override { return port_; }
  int ops_port() const override { return ops_ == nullptr ? 0 : ops_->port(); }
  std::shared_ptr<grpc::Channel> InProcessChannel() override;
  void Shutdown(std::chrono::milliseconds grace) override;

 private:
  absl::Status OpenStore();
  absl::Status OpenTraverses();
  absl::Status OpenOperationsPort();
  absl::Status Listen();
  void AddServices(grpc::ServerBuilder& builder);
  void ExpireUploads(const std::stop_token& stop);
  void AwaitCalls(std::chrono::steady_clock::time_point until) const;
  CallEnvironment Calls();
  ScanSources Scans();

  const ServerConfig config_;
  const LimitsConfig limits_;
  std::unique_ptr<Logger> logger_;
  std::unique_ptr<Access> access_;
  Metrics metrics_;
  MemoryBudget memory_;
  PreparedScanCache cache_;
  std::unique_ptr<ScanStore> store_;
  WorkerPool pool_;
  WorkerPool disk_pool_;
  std::unique_ptr<Traverses> traverses_;
  std::unique_ptr<MapBuilder> maps_;
  std::atomic<int> num_open_calls_ = 0;
  std::stop_source draining_;
  std::stop_source ending_;
  std::atomic<const char*> not_ready_ = "starting";  // empty: it is
  HealthService health_;
  std::unique_ptr<RegistrationService> registration_service_;
  std::unique_ptr<ScanService> scan_service_;
  std::unique_ptr<TraverseService> traverse_service_;
  std::unique_ptr<grpc::Server> grpc_server_;
  std::unique_ptr<OpsServer> ops_;
  int port_ = 0;
  std::jthread expiry_;
  std::once_flag shut_down_;
};

CallEnvironment ServerImpl::Calls() {
  return {.access = access_.get(),
          .metrics = &metrics_,
          .logger = logger_.get(),
          .num_open = &num_open_calls_,
          .draining = draining_.get_token(),
          .ending = ending_.get_token()};
}

ScanSources ServerImpl::Scans() {
  return {.limits = limits_, .memory = &memory_, .cache = &cache_, .store = store_.get(), .metrics = &metrics_};
}

absl::Status ServerImpl::Open() {
  absl::StatusOr<std::unique_ptr<Logger>> logger = Logger::Create(config_.log, stderr);
  if (!logger.ok()) return logger.status();
  logger_ = *std::move(logger);
  if (config_.token_file.empty()) {
    access_ = Access::Open();
  } else {
    absl::StatusOr<std::unique_ptr<Access>> access =
        Access::FromFile(config_.token_file, config_.tls.reload_seconds, *logger_);
    if (!access.ok()) return access.status();
    access_ = *std::move(access);
  }
  // The operations port first: it tells that the server is alive, and not ready yet.
  if (absl::Status status = OpenOperationsPort(); !status.ok()) return status;
  if (absl::Status status = OpenStore(); !status.ok()) return status;
  if (absl::Status status = WarmUp(); !status.ok()) return status;
  if (absl::Status status = OpenTraverses(); !status.ok()) return status;
  if (absl::Status status = Listen(); !status.ok()) return status;
  expiry_ = std::jthread([this](const std::stop_token& stop) { ExpireUploads(stop); });
  for (const char* service : {"", kRegistrationServiceName, kScanServiceName, kTraverseServiceName}) {
    health_.SetServing(service, true);
  }
  not_ready_ = "";
  return absl::OkStatus();
}

absl::Status ServerImpl::OpenInProcess() {
  logger_ = Logger::Silent();
  access_ = Access::Open();
  grpc::ServerBuilder builder;
  builder.SetMaxReceiveMessageSize(-1).SetMaxSendMessageSize(-1);
  AddServices(builder);
  grpc_server_ = builder.BuildAndStart();
  if (grpc_server_ == nullptr) return absl::InternalError("cannot start the service in this process");
  for (const char* service : {"", kRegistrationServiceName}) health_.SetServing(service, true);
  return absl::OkStatus();
}

absl::Status ServerImpl::OpenOperationsPort() {
  AddServerGauges(metrics_, {.pool = &pool_, .memory = &memory_, .cache = &cache_});
  if (config_.ops_listen.empty()) return absl::OkStatus();
  const auto not_ready = [this]() -> std::string { return not_ready_.load(); };
  absl::StatusOr<std::unique_ptr<OpsServer>> ops =
      OpsServer::Start(config_.ops_listen, {.metrics = [this] { return metrics_.Text(); }, .not_ready = not_ready});
  if (!ops.ok()) return ops.status();
  ops_ = *std::move(ops);
  return absl::OkStatus();
}

absl::Status ServerImpl::OpenStore() {
  absl::StatusOr<std::unique_ptr<ScanStore>> store =
      ScanStore::Open(config_.data_dir, {.max_stored_bytes = limits_.max_stored_bytes,
                                         .max_uploads = limits_.max_uploads,
                                         .upload_lifetime = std::chrono::seconds(limits_.upload_lifetime_seconds)});
  if (!store.ok()) return store.status();
  store_ = *std::move(store);
  AddStoreGauges(metrics_, *store_, limits_.max_stored_bytes, config_.data_dir);
  LogRecovery(*store_, config_.data_dir, *logger_);
  return absl::OkStatus();
}

absl::Status ServerImpl::OpenTraverses() {
  absl::StatusOr<std::unique_ptr<MapBuilder>> maps =
      MapBuilder::Open(config_.data_dir, {.limits = limits_, .store = store_.get(), .memory = &memory_});
  if (!maps.ok()) return maps.status();
  maps_ = *std::move(maps);
  absl::StatusOr<std::unique_ptr<Traverses>> traverses =
      Traverses::Open(config_.data_dir, {.scans = Scans(), .pool = &pool_, .logger = logger_.get()});
  if (!traverses.ok()) return traverses.status();
  traverses_ = *std::move(traverses);
  metrics_.SetGauge("curvereg_traverses", "Traverses that are kept",
                    [this] { return static_cast<double>(traverses_->num_traverses()); });
  return absl::OkStatus();
}

void ServerImpl::AddServices(grpc::ServerBuilder& builder) {
  registration_service_ =
      std::make_unique<RegistrationService>(RegistrationBackend{.calls = Calls(), .scans = Scans(), .pool = &pool_});
  builder.RegisterService(registration_service_.get());
  builder.RegisterService(&health_);
  if (store_ == nullptr) return;
  scan_service_ = std::make_unique<ScanService>(
      ScanBackend{.calls = Calls(),
                  .limits = limits_,
                  .disk_pool = &disk_pool_,
                  .memory = &memory_,
                  .store = store_.get(),
                  .delete_scan = [this](const std::string& scan_id) { return traverses_->DeleteScan(scan_id); }});
  builder.RegisterService(scan_service_.get());
  if (traverses_ == nullptr) return;
  traverse_service_ = std::make_unique<TraverseService>(TraverseBackend{.calls = Calls(),
                                                                        .scans = Scans(),
                                                                        .pool = &pool_,
                                                                        .disk_pool = &disk_pool_,
                                                                        .traverses = traverses_.get(),
                                                                        .maps = maps_.get()});
  builder.RegisterService(traverse_service_.get());
}

absl::Status ServerImpl::Listen() {
  const bool has_port = !config_.listen.empty();
  const absl::StatusOr<std::shared_ptr<grpc::ServerCredentials>> credentials = MakeServerCredentials(config_.tls);
  if (!credentials.ok()) return credentials.status();
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  grpc::ServerBuilder builder;
  if (has_port) builder.AddListeningPort(config_.listen, *credentials, &port_);
  builder.SetMaxReceiveMessageSize(static_cast<int>(limits_.max_message_bytes));
  builder.SetMaxSendMessageSize(-1);
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);  // two servers on one port would share its calls
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, limits_.max_streams_per_connection);
  // Pings find clients that vanished; clients may ping us as often as every 10 s.
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, 30'000);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 20'000);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, 10'000);
  grpc::ResourceQuota quota("curvereg");
  quota.Resize(static_cast<std::size_t>(std::max(kLeastQuotaBytes, limits_.memory_bytes)));
  builder.SetResourceQuota(quota);
  AddServices(builder);
  grpc_server_ = builder.BuildAndStart();
  if (grpc_server_ == nullptr || (has_port && port_ == 0)) {
    return absl::UnavailableError(absl::StrCat("listen: cannot listen on ", config_.listen));
  }
  return absl::OkStatus();
}

std::shared_ptr<grpc::Channel> ServerImpl::InProcessChannel() {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(-1);
  arguments.SetMaxSendMessageSize(-1);
  return grpc_server_->InProcessChannel(arguments);
}

void ServerImpl::ExpireUploads(const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any wake;
  std::unique_lock lock(mutex);
  while (!stop.stop_requested()) {
    const absl::StatusOr<int> expired = store_->ExpireUploads(std::chrono::system_clock::now());
    if (!expired.ok()) {
      logger_->Error("expiry_failed", {{"message", std::string(expired.status().message())}});
    } else if (*expired > 0) {
      logger_->Info("uploads_expired", {{"count", static_cast<int64_t>(*expired)}});
    }
    wake.wait_for(lock, stop, kExpiryInterval, [] { return false; });
  }
}

// Until none is open.
void ServerImpl::AwaitCalls(std::chrono::steady_clock::time_point until) const {
  while (num_open_calls_ > 0 && std::chrono::steady_clock::now() < until) std::this_thread::sleep_for(kDrainPoll);
}

void ServerImpl::Shutdown(std::chrono::milliseconds grace) {
  std::call_once(shut_down_, [&] {
    const auto deadline = std::chrono::steady_clock::now() + grace;
    not_ready_ = "draining";
    health_.Drain();
    std::this_thread::sleep_for(std::min(grace, std::chrono::milliseconds(config_.drain_delay_ms)));
    draining_.request_stop();
    health_.EndWatches();
    AwaitCalls(deadline - kEndingMargin);
    // Reaches the core's loops. Each call ends with an error of ours, while there is still a connection for it.
    ending_.request_stop();
    AwaitCalls(deadline - kFlushTime);
    // What is left, of clients that do not read, gRPC cancels. It would wait for idle connections as well, whose
    // clients may take seconds to notice.
    if (grpc_server_ != nullptr) grpc_server_->Shutdown(std::chrono::system_clock::now() + kFlushTime);
    if (traverses_ != nullptr) traverses_->Close();
    pool_.Shutdown(std::chrono::steady_clock::now());
    disk_pool_.Shutdown(std::chrono::steady_clock::now());
    expiry_ = std::jthread();
    ops_.reset();
  });
}

}  // namespace

absl::StatusOr<std::unique_ptr<Server>> Server::Start(const ServerConfig& config) {
  if (absl::Status status = Validate(config); !status.ok()) return status;
  auto server = std::make_unique<ServerImpl>(config);
  if (absl::Status status = server->Open(); !status.ok()) return status;
  return server;
}

absl::StatusOr<std::unique_ptr<Server>> Server::StartWithoutPort(const ServerConfig& config) {
  ServerConfig own = config;
  own.tls = {};
  own.token_file.clear();
  own.listen = ServerConfig().listen;
  own.ops_listen.clear();
  if (absl::Status status = Validate(own); !status.ok()) return status;
  own.listen.clear();
  auto server = std::make_unique<ServerImpl>(own);
  if (absl::Status status = server->Open(); !status.ok()) return status;
  return server;
}

absl::StatusOr<std::unique_ptr<Server>> Server::StartInProcess(const ServerConfig& config) {
  ServerConfig own = config;
  own.drain_delay_ms = 0;
  // One user, who has the whole machine.
  own.limits.max_scan_points = 50'000'000;
  own.limits.max_scan_bytes = uint64_t{1} << 31;
  // What a scan may need at worst is far above what it needs; nobody else is to be kept from starving.
  own.limits.memory_bytes = uint64_t{1} << 50;
  own.limits.cache_bytes = 1;  // scans without a name are not kept
  auto server = std::make_unique<ServerImpl>(own);
  if (absl::Status status = server->OpenInProcess(); !status.ok()) return status;
  return server;
}

}  // namespace curvereg::server
