// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Upload throughput beside that of a bare gRPC stream: the same bytes in chunks of the same size to a service that
// looks at nothing and keeps nothing, in turn, over loopback.
#include <grpcpp/create_channel.h>
#include <grpcpp/server_builder.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "bench/service_fixture.h"
#include "curvereg/v1/scan_service.grpc.pb.h"

namespace curvereg {
namespace {

constexpr uint32_t kChunkBytes = 1 << 20;
constexpr std::size_t kNumPoints = 20'000'000;  // 240 MB
constexpr int kRounds = 9;

// Reads a stream to its end and answers once.
class Sink final : public v1::ScanService::CallbackService {
  class Reader final : public grpc::ServerBidiReactor<v1::UploadScanRequest, v1::UploadScanResponse> {
   public:
    Reader() { StartRead(&request_); }
    void OnReadDone(bool ok) override {
      if (ok) {
        StartRead(&request_);
      } else {
        StartWriteAndFinish(&response_, {}, grpc::Status::OK);
      }
    }
    void OnDone() override { delete this; }

   private:
    v1::UploadScanRequest request_;
    v1::UploadScanResponse response_;
  };
  grpc::ServerBidiReactor<v1::UploadScanRequest, v1::UploadScanResponse>* UploadScan(
      grpc::CallbackServerContext*) override {
    return new Reader;
  }
};

// Bytes a second of `payload` in chunks to the sink.
double BareThroughput(v1::ScanService::Stub& stub, const std::string& payload) {
  const auto start = std::chrono::steady_clock::now();
  grpc::ClientContext context;
  const auto stream = stub.UploadScan(&context);
  v1::UploadScanRequest request;
  for (std::size_t offset = 0; offset < payload.size(); offset += kChunkBytes) {
    request.mutable_chunk()->set_offset(offset);
    request.mutable_chunk()->set_data(payload.data() + offset,
                                      std::min<std::size_t>(kChunkBytes, payload.size() - offset));
    stream->Write(request);
  }
  stream->WritesDone();
  v1::UploadScanResponse response;
  while (stream->Read(&response)) {
  }
  if (!stream->Finish().ok()) std::exit(1);
  return static_cast<double>(payload.size()) /
         std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Bytes a second.
struct Rates {
  double transfer = 0.0;  // until all bytes were acknowledged
  double whole = 0.0;     // until the scan was stored
};

Rates UploadRates(Client& client, const Scan& scan) {
  using Clock = std::chrono::steady_clock;
  const auto seconds = [](Clock::duration duration) { return std::chrono::duration<double>(duration).count(); };
  Clock::time_point start, acknowledged;
  TransferOptions options;
  options.encoding.kind = TransferEncoding::Kind::kRaw;
  options.chunk_bytes = kChunkBytes;
  options.progress = [&](const TransferProgress& progress) {
    if (progress.bytes_done == progress.bytes_total && acknowledged == Clock::time_point()) acknowledged = Clock::now();
  };
  start = Clock::now();
  const auto outcome = client.UploadScan(scan, options);
  const double whole_seconds = seconds(Clock::now() - start);
  if (!outcome.ok() || outcome->already_stored) {
    std::fprintf(stderr, "%s\n", outcome.status().ToString().c_str());
    std::exit(1);
  }
  static_cast<void>(client.DeleteScan(outcome->scan.name));
  const auto bytes = static_cast<double>(outcome->scan.payload_bytes);
  return {bytes / seconds(acknowledged - start), bytes / whole_seconds};
}

int Main() {
  Scan scan;
  std::mt19937 random(1);
  std::uniform_real_distribution<float> coordinate(-50.0F, 50.0F);
  for (std::size_t i = 0; i < kNumPoints; ++i) {
    scan.points.emplace_back(coordinate(random), coordinate(random), coordinate(random));
  }
  const std::string payload(reinterpret_cast<const char*>(scan.points.data()), scan.points.size() * 12);

  Sink sink;
  int port = 0;
  grpc::ServerBuilder builder;
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port).RegisterService(&sink);
  const std::unique_ptr<grpc::Server> bare = builder.BuildAndStart();
  v1::ScanService::Stub stub(
      grpc::CreateChannel("127.0.0.1:" + std::to_string(port), grpc::InsecureChannelCredentials()));
  server::LimitsConfig limits;
  limits.max_scan_points = 2 * kNumPoints;
  limits.max_scan_bytes = 2 * payload.size();
  limits.memory_bytes = 16 * payload.size();
  const bench::LoopbackService service(limits);
  const std::unique_ptr<Client> client = service.Connect();

  std::vector<double> bare_rates, transfer_rates, transfer_ratios, whole_ratios;
  for (int round = -1; round < kRounds; ++round) {
    const double bare_rate = BareThroughput(stub, payload);
    const Rates upload = UploadRates(*client, scan);
    if (round < 0) continue;
    bare_rates.push_back(bare_rate);
    transfer_rates.push_back(upload.transfer);
    transfer_ratios.push_back(upload.transfer / bare_rate);
    whole_ratios.push_back(upload.whole / bare_rate);
  }
  const auto median = [](std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
    return values[values.size() / 2];
  };
  std::printf(
      "%zu bytes in chunks of %u: bare stream %.0f MB/s, upload %.0f MB/s; median of ratios %.2f until all bytes "
      "are acknowledged (at least 0.8), %.2f until the scan is on the disk\n",
      payload.size(), kChunkBytes, median(bare_rates) * 1e-6, median(transfer_rates) * 1e-6, median(transfer_ratios),
      median(whole_ratios));
  return 0;
}

}  // namespace
}  // namespace curvereg

int main() { return curvereg::Main(); }
