// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A real server under more work than it can do, beside many slow clients, and for a long time.
// CURVEREG_TEST_OVERLOAD_SECONDS and CURVEREG_TEST_REGISTRATIONS change how long.
#include <grpcpp/alarm.h>
#include <grpcpp/create_channel.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <deque>
#include <mutex>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/client.h"
#include "curvereg/v1/registration_service.grpc.pb.h"
#include "curvereg/v1/scan_service.grpc.pb.h"
#include "grpc/health/v1/health.grpc.pb.h"
#include "tests/testing/matchers.h"
#include "tests/testing/server_process.h"
#include "tests/testing/simulated.h"
#include "tests/testing/test_data.h"
#include "wire/digest.h"
#include "wire/error.h"
#include "wire/point_codec.h"
#include "wire/status_mapping.h"

namespace curvereg {
namespace {

using std::chrono::steady_clock;
using testing::IsOk;

// Of the capacity, of the time without slow clients, and of what is meant to be sent. A sanitizer slows some work more
// than other, so there no more is held than the order of magnitude.
#ifdef CURVEREG_SANITIZED
constexpr double kLeastGoodput = 0.5;
constexpr double kMostSlowdown = 2.0;
constexpr double kLeastCalls = 0.5;
constexpr double kLeastBytes = 0.4;
#else
constexpr double kLeastGoodput = 0.9;
constexpr double kMostSlowdown = 1.2;
constexpr double kLeastCalls = 0.9;
constexpr double kLeastBytes = 0.8;
#endif

int FromEnvironment(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::atoi(text);
}

double SecondsSince(steady_clock::time_point start) {
  return std::chrono::duration<double>(steady_clock::now() - start).count();
}

std::shared_ptr<grpc::Channel> OwnChannel(const testing::ServerProcess& server) {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);  // one connection for each: each is a client of its own
  return grpc::CreateCustomChannel(server.target(), grpc::InsecureChannelCredentials(), arguments);
}

// A server with two stored scans of a yard.
class LoadedServer {
 public:
  LoadedServer(const std::string& preset, const std::vector<std::string>& arguments)
      : server_(CURVEREG_SERVER_EXECUTABLE, folder_.path(), arguments) {
    const testing::ScanPairWithTruth pair = testing::PairOf(preset, 1, 0);
    auto client = Client::Connect(server_.target());
    EXPECT_THAT(client, IsOk());
    TransferOptions raw;
    raw.encoding.kind = TransferEncoding::Kind::kRaw;
    request_.mutable_source()->set_name((*client)->UploadScan(pair.source, raw)->scan.name);
    request_.mutable_target()->set_name((*client)->UploadScan(pair.target, raw)->scan.name);
    request_.mutable_options()->set_max_threads(1);
  }
  testing::ServerProcess& server() { return server_; }
  const v1::RegisterScansRequest& request() const { return request_; }

 private:
  testing::TemporaryFolder folder_;
  testing::ServerProcess server_;
  v1::RegisterScansRequest request_;
};

struct Answers {
  int num_answers = 0;
  int num_errors = 0;
};

// Of registrations in `seconds`, by `num_clients` clients that each wait for their answer.
Answers CountAnswers(LoadedServer& loaded, int num_clients, double seconds) {
  std::atomic<int> num_answers = 0, num_errors = 0;
  const auto start = steady_clock::now();
  std::vector<std::jthread> clients;
  for (int i = 0; i < num_clients; ++i) {
    clients.emplace_back([&] {
      const auto stub = v1::RegistrationService::NewStub(OwnChannel(loaded.server()));
      while (SecondsSince(start) < seconds) {
        grpc::ClientContext context;
        v1::RegisterScansResponse response;
        const bool ok = stub->RegisterScans(&context, loaded.request(), &response).ok();
        ++(ok ? num_answers : num_errors);
      }
    });
  }
  clients.clear();
  return {num_answers, num_errors};
}

// Sends calls at a given rate whatever becomes of them, and counts what becomes of them.
class Flood {
 public:
  Flood(LoadedServer& loaded, int num_clients) : loaded_(loaded) {
    for (int i = 0; i < num_clients; ++i) {
      stubs_.push_back(v1::RegistrationService::NewStub(OwnChannel(loaded.server())));
    }
  }
  ~Flood() {
    std::unique_lock lock(mutex_);
    all_ended_.wait(lock, [this] { return num_open_ == 0; });
  }

  void Send() {
    auto* call = new Call;
    {
      const std::lock_guard lock(mutex_);
      ++num_open_;
    }
    auto& stub = stubs_[next_++ % stubs_.size()];
    stub->async()->RegisterScans(&call->context, &loaded_.request(), &call->response,
                                 [this, call](const grpc::Status& status) { End(call, status); });
  }

  std::atomic<int> num_answers = 0, num_refusals = 0, num_others = 0, num_bare_refusals = 0;

 private:
  struct Call {
    grpc::ClientContext context;
    v1::RegisterScansResponse response;
  };
  void End(Call* call, const grpc::Status& status) {
    if (status.ok()) {
      ++num_answers;
    } else if (status.error_code() == grpc::StatusCode::RESOURCE_EXHAUSTED) {
      ++num_refusals;
      const bool has_pushback = call->context.GetServerTrailingMetadata().count("grpc-retry-pushback-ms") == 1;
      if (!has_pushback || !wire::RetryDelayOf(wire::FromGrpcStatus(status)).has_value()) ++num_bare_refusals;
    } else {
      ++num_others;
    }
    delete call;
    const std::lock_guard lock(mutex_);
    if (--num_open_ == 0) all_ended_.notify_all();
  }

  LoadedServer& loaded_;
  std::vector<std::unique_ptr<v1::RegistrationService::Stub>> stubs_;
  std::size_t next_ = 0;
  std::mutex mutex_;
  std::condition_variable all_ended_;
  int num_open_ = 0;
};

bool IsServing(grpc::health::v1::Health::Stub& stub) {
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(5));
  grpc::health::v1::HealthCheckResponse response;
  return stub.Check(&context, {}, &response).ok() &&
         response.status() == grpc::health::v1::HealthCheckResponse::SERVING;
}

TEST(ServerLoadTest, TenTimesTheCapacityLeavesTheGoodputAndTheMemoryAlone) {
  constexpr uint64_t kMostGrowth = uint64_t{512} << 20;
  // Enough for as many registrations as there are workers: each reserves what its scans could need at most, 280 MB.
  constexpr uint64_t kBudget = uint64_t{4} << 30;
  // Scans are prepared for each call: registrations of 50 ms, as on a server that sees ever new scans.
  LoadedServer loaded("mars-yard-sim", {"--limits-cache-bytes", "1", "--limits-memory-bytes", std::to_string(kBudget)});
  const double seconds = FromEnvironment("CURVEREG_TEST_OVERLOAD_SECONDS", 60);
  const double capacity_seconds = std::max(5.0, seconds / 6);
  CountAnswers(loaded, 4, 2.0);
  const uint64_t memory_before = loaded.server().ResidentBytes();
  const Answers unhurried = CountAnswers(loaded, 4, capacity_seconds);
  EXPECT_EQ(unhurried.num_errors, 0) << "this is no overload";
  const double capacity = unhurried.num_answers / capacity_seconds;

  int num_sent = 0, num_unhealthy = 0, num_checks = 0;
  uint64_t most_memory = 0;
  double goodput = 0.0;
  {
    Flood flood(loaded, 8);
    const auto health = grpc::health::v1::Health::NewStub(OwnChannel(loaded.server()));
    const auto start = steady_clock::now();
    const auto interval = std::chrono::duration<double>(1.0 / (10.0 * capacity));
    for (; SecondsSince(start) < seconds; ++num_sent) {
      std::this_thread::sleep_until(start + std::chrono::duration_cast<steady_clock::duration>(num_sent * interval));
      flood.Send();
      if (num_sent % 50 != 0) continue;
      ++num_checks;
      if (!IsServing(*health)) ++num_unhealthy;
      most_memory = std::max(most_memory, loaded.server().ResidentBytes());
    }
    goodput = flood.num_answers / SecondsSince(start);
    EXPECT_EQ(flood.num_others, 0);
    EXPECT_EQ(flood.num_bare_refusals, 0) << "every refusal tells when to come back";
    EXPECT_GT(flood.num_refusals, flood.num_answers);
    std::printf("capacity %.1f/s, goodput at %.1f times as much %.1f/s (%.2f), %d refused, memory %.0f -> %.0f MB\n",
                capacity, num_sent / (capacity * seconds), goodput, goodput / capacity, flood.num_refusals.load(),
                static_cast<double>(memory_before) * 1e-6, static_cast<double>(most_memory) * 1e-6);
  }
  EXPECT_EQ(num_unhealthy, 0) << "of " << num_checks;
  EXPECT_GE(num_sent, kLeastCalls * 10.0 * capacity * seconds) << "this is no overload of ten times the capacity";
  EXPECT_GE(goodput, kLeastGoodput * capacity);
  EXPECT_LE(most_memory, memory_before + kMostGrowth);
  EXPECT_GT(CountAnswers(loaded, 2, 1.0).num_answers, 0) << "it goes on afterwards";
}

// Uploads a scan forever at 10 kB/s, without a thread of its own.
class SlowClient {
 public:
  SlowClient(const testing::ServerProcess& server, int number) : channel_(OwnChannel(server)) {
    stub_ = v1::ScanService::NewStub(channel_);
    stream_ = stub_->UploadScan(&context_);
    v1::UploadScanRequest request;
    auto* start = request.mutable_start();
    start->set_upload("uploads/slow-" + std::to_string(number));
    Scan scan;
    scan.points.assign(500'000, Eigen::Vector3f(1.0F, 2.0F, 3.0F));
    *start->mutable_header() = wire::EncodeScan(scan)->header();
    start->set_payload_bytes(scan.points.size() * 12);
    v1::UploadScanResponse response;
    alive_ = stream_->Write(request) && stream_->Read(&response) && response.has_ready();
  }
  ~SlowClient() {
    context_.TryCancel();
    static_cast<void>(stream_->Finish());
  }
  void SendPiece() {
    v1::UploadScanRequest request;
    request.mutable_chunk()->set_offset(offset_);
    request.mutable_chunk()->set_data(std::string(kPieceBytes, 'x'));
    request.mutable_chunk()->set_crc32c(wire::Crc32c(request.chunk().data()));
    offset_ += kPieceBytes;
    v1::UploadScanResponse response;
    alive_ = alive_ && stream_->Write(request) && stream_->Read(&response) &&
             response.progress().committed_offset() == offset_;
  }
  bool alive() const { return alive_; }
  uint64_t sent_bytes() const { return offset_; }
  static constexpr std::size_t kPieceBytes = 10'000;

 private:
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<v1::ScanService::Stub> stub_;
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<v1::UploadScanRequest, v1::UploadScanResponse>> stream_;
  uint64_t offset_ = 0;
  bool alive_ = false;
};

// Median seconds of a registration of stored scans and of an upload of a new one.
struct FastTimes {
  double registration = 0.0;
  double upload = 0.0;
};

FastTimes MeasureFastClient(LoadedServer& loaded, uint32_t seed) {
  auto client = Client::Connect(loaded.server().target());
  EXPECT_THAT(client, IsOk());
  std::vector<double> registrations, uploads;
  Scan scan = testing::PairOf("mars-yard-sim", 0, 0).source;
  TransferOptions raw;
  raw.encoding.kind = TransferEncoding::Kind::kRaw;
  for (int i = 0; i < 60; ++i) {
    auto start = steady_clock::now();
    EXPECT_THAT((*client)->RegisterScans(loaded.request().source().name(), loaded.request().target().name()), IsOk());
    registrations.push_back(SecondsSince(start));
    scan.points[0].x() = static_cast<float>(seed) + 0.01F * static_cast<float>(i);  // another scan each time
    start = steady_clock::now();
    EXPECT_THAT((*client)->UploadScan(scan, raw), IsOk());
    uploads.push_back(SecondsSince(start));
  }
  const auto median = [](std::vector<double>& values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
    return values[values.size() / 2];
  };
  return {median(registrations), median(uploads)};
}

TEST(ServerLoadTest, TwoHundredSlowClientsDoNotSlowAFastOne) {
  static constexpr int kSlowClients = 200;
  LoadedServer loaded("mars-yard-sim", {});
  MeasureFastClient(loaded, 1);
  FastTimes alone = MeasureFastClient(loaded, 2);
  std::deque<SlowClient> slow;
  for (int i = 0; i < kSlowClients; ++i) slow.emplace_back(loaded.server(), i);
  std::jthread sender([&slow](const std::stop_token& stop) {
    const auto start = steady_clock::now();
    for (int i = 0; !stop.stop_requested(); ++i) {
      std::this_thread::sleep_until(start + i * std::chrono::milliseconds(1000) / kSlowClients);
      slow[static_cast<std::size_t>(i % kSlowClients)].SendPiece();
    }
  });
  const auto start = steady_clock::now();
  const FastTimes beside = MeasureFastClient(loaded, 3);
  const double seconds = SecondsSince(start);
  sender.request_stop();
  sender.join();
  const FastTimes alone_again = MeasureFastClient(loaded, 4);
  alone.registration = std::max(alone.registration, alone_again.registration);
  alone.upload = std::max(alone.upload, alone_again.upload);
  uint64_t sent_bytes = 0;
  for (const SlowClient& client : slow) sent_bytes += client.sent_bytes();
  const double bytes_per_second = static_cast<double>(sent_bytes) / (seconds * kSlowClients);
  std::printf("registration %.1f ms alone, %.1f ms beside %d slow clients of %.1f kB/s; upload %.1f ms, %.1f ms\n",
              1e3 * alone.registration, 1e3 * beside.registration, kSlowClients, 1e-3 * bytes_per_second,
              1e3 * alone.upload, 1e3 * beside.upload);
  EXPECT_LE(beside.registration, kMostSlowdown * alone.registration);
  EXPECT_LE(beside.upload, kMostSlowdown * alone.upload);
  EXPECT_GE(bytes_per_second, kLeastBytes * SlowClient::kPieceBytes) << "slow acknowledgements held the load back";
  for (const SlowClient& client : slow) EXPECT_TRUE(client.alive());
}

TEST(ServerLoadTest, MemoryStaysAfterTenThousandRegistrations) {
#ifdef CURVEREG_SANITIZED
  GTEST_SKIP() << "sanitizers need memory of their own";
#endif
  const int total = FromEnvironment("CURVEREG_TEST_REGISTRATIONS", 10'000);
  LoadedServer loaded("sparse", {});
  std::atomic<int> num_started = 0, num_failed = 0;
  const auto register_until = [&](int end) {
    std::vector<std::jthread> clients;
    for (int i = 0; i < 2; ++i) {
      clients.emplace_back([&] {
        const auto stub = v1::RegistrationService::NewStub(OwnChannel(loaded.server()));
        while (num_started++ < end) {
          grpc::ClientContext context;
          v1::RegisterScansResponse response;
          if (!stub->RegisterScans(&context, loaded.request(), &response).ok()) ++num_failed;
        }
      });
    }
  };
  register_until(total / 10);
  const uint64_t early = loaded.server().ResidentBytes();
  num_started = total / 10;
  register_until(total);
  const uint64_t late = loaded.server().ResidentBytes();
  std::printf("memory %.1f MB after %d registrations, %.1f MB after %d\n", static_cast<double>(early) * 1e-6,
              total / 10, static_cast<double>(late) * 1e-6, total);
  EXPECT_EQ(num_failed, 0);
  EXPECT_LE(static_cast<double>(late), 1.05 * static_cast<double>(early));
}

}  // namespace
}  // namespace curvereg
