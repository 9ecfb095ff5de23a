// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Upload throughput beside that of a bare gRPC stream: the same bytes in chunks of the same size to a service that
// looks at nothing and keeps nothing, in turn, over loopback. And what an upload must do besides, each alone on one
// thread: with two cores for both ends that work is what parts the two. Over plain text, and over TLS as anybody beyond
// loopback must.
#include <fcntl.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/server_builder.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/service_fixture.h"
#include "core/scan/scan.h"
#include "curvereg/v1/scan_service.grpc.pb.h"
#include "server/settings/small_file.h"
#include "tests/testing/certificates.h"
#include "wire/digest.h"

namespace curvereg {
namespace {

constexpr uint32_t kChunkBytes = 1 << 20;
constexpr std::size_t kNumPoints = 20'000'000;  // 240 MB
constexpr int kRounds = 9;

using Clock = std::chrono::steady_clock;

double Seconds(Clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

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

// Of all threads so far.
double ProcessorSeconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

// What it took to send the payload.
struct Cost {
  double transfer = 0.0;   // [s] until all bytes were acknowledged
  double whole = 0.0;      // [s] until the scan was stored; of a bare stream the same
  double processor = 0.0;  // [s] of both ends, until then
};

// `payload` in chunks to the sink.
Cost SendBare(v1::ScanService::Stub& stub, const std::string& payload) {
  const double processor_before = ProcessorSeconds();
  const auto start = Clock::now();
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
  if (const grpc::Status status = stream->Finish(); !status.ok()) bench::Fail(status.error_message());
  const double seconds = Seconds(Clock::now() - start);
  return {seconds, seconds, ProcessorSeconds() - processor_before};
}

Cost Upload(Client& client, const Scan& scan) {
  Clock::time_point acknowledged;
  TransferOptions options;
  options.encoding.kind = TransferEncoding::Kind::kRaw;
  options.chunk_bytes = kChunkBytes;
  options.progress = [&](const TransferProgress& progress) {
    if (progress.bytes_done == progress.bytes_total && acknowledged == Clock::time_point()) acknowledged = Clock::now();
  };
  const double processor_before = ProcessorSeconds();
  const auto start = Clock::now();
  const auto outcome = client.UploadScan(scan, options);
  const Cost cost = {Seconds(acknowledged - start), Seconds(Clock::now() - start),
                     ProcessorSeconds() - processor_before};
  if (!outcome.ok()) bench::Fail(outcome.status().ToString());
  if (outcome->already_stored) bench::Fail("the scan is still stored");
  static_cast<void>(client.DeleteScan(outcome->scan.name));
  return cost;
}

// Of `of` for each round.
template <typename Of>
double Median(const std::vector<std::pair<Cost, Cost>>& rounds, const Of& of) {
  std::vector<double> values;
  for (const auto& [bare, upload] : rounds) values.push_back(of(bare, upload));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

void Print(const char* transport, const std::vector<std::pair<Cost, Cost>>& rounds, std::size_t num_bytes) {
  const auto megabytes = static_cast<double>(num_bytes) * 1e-6;
  const auto median = [&](const auto& of) { return Median(rounds, of); };
  std::printf(
      "%s, %.0f MB in chunks of %u: bare stream %.0f MB/s (%.0f ms of processor time), upload %.0f MB/s (%.0f ms); "
      "median of ratios %.2f until all bytes are acknowledged (at least 0.8), %.2f until the scan is on the disk\n",
      transport, megabytes, kChunkBytes,
      median([&](const Cost& bare, const Cost&) { return megabytes / bare.transfer; }),
      median([](const Cost& bare, const Cost&) { return 1e3 * bare.processor; }),
      median([&](const Cost&, const Cost& upload) { return megabytes / upload.transfer; }),
      median([](const Cost&, const Cost& upload) { return 1e3 * upload.processor; }),
      median([](const Cost& bare, const Cost& upload) { return bare.transfer / upload.transfer; }),
      median([](const Cost& bare, const Cost& upload) { return bare.whole / upload.whole; }));
}

// [s] of `work` on `payload` in chunks.
template <typename Work>
double SecondsOf(const std::string& payload, const Work& work) {
  const auto start = Clock::now();
  for (std::size_t offset = 0; offset < payload.size(); offset += kChunkBytes) {
    work(offset, std::string_view(payload).substr(offset, kChunkBytes));
  }
  return Seconds(Clock::now() - start);
}

// [s] to hand `payload` to the kernel for a new file, which is what `kill -9` does not undo.
double SecondsToWrite(const std::string& payload) {
  std::string path = (std::filesystem::temp_directory_path() / "curvereg-bench-XXXXXX").string();
  const int fd = mkstemp(path.data());
  if (fd < 0) bench::Fail("no temporary file");
  unlink(path.c_str());
  const double seconds = SecondsOf(payload, [fd](std::size_t offset, std::string_view chunk) {
    const ssize_t written = pwrite(fd, chunk.data(), chunk.size(), static_cast<off_t>(offset));
    if (written != static_cast<ssize_t>(chunk.size())) bench::Fail("the temporary file cannot be written");
  });
  close(fd);
  return seconds;
}

void PrintOwnWork(const std::string& payload) {
  wire::Digester digester = wire::Digester::Create(v1::DIGEST_ALGORITHM_XXH3_128).value();
  const double digest = SecondsOf(payload, [&](std::size_t, std::string_view chunk) { digester.Update(chunk); });
  uint32_t crc32c = 0;
  const double checksum =
      SecondsOf(payload, [&](std::size_t, std::string_view chunk) { crc32c = wire::ExtendCrc32c(crc32c, chunk); });
  FinitePointCounter counter;
  const double count = SecondsOf(payload, [&](std::size_t, std::string_view chunk) { counter.Update(chunk); });
  const double write = SecondsToWrite(payload);
  std::printf(
      "an upload's own work: digest %.0f ms and checksums %.0f ms at each end, counting points %.0f ms, writing the "
      "file %.0f ms: %.0f ms of processor time (scan %s, %08x)\n",
      1e3 * digest, 1e3 * checksum, 1e3 * count, 1e3 * write, 1e3 * (2.0 * (digest + checksum) + count + write),
      wire::HexText(digester.Digest().value()).c_str(), crc32c);
}

// Over TLS with the certificates "server" and "authority"; null: over plain text.
void Compare(const testing::Certificates* certificates, const Scan& scan, const std::string& payload) {
  Sink sink;
  int port = 0;
  std::shared_ptr<grpc::ServerCredentials> server_credentials = grpc::InsecureServerCredentials();
  std::shared_ptr<grpc::ChannelCredentials> client_credentials = grpc::InsecureChannelCredentials();
  server::TlsConfig tls;
  ClientOptions options;
  if (certificates != nullptr) {
    tls.certificate_file = certificates->Pem("server");
    tls.key_file = certificates->Key("server");
    options.tls.enabled = true;
    options.tls.ca_file = certificates->Pem("authority");
    grpc::SslServerCredentialsOptions own;
    own.pem_key_cert_pairs = {
        {server::ReadSmallFile(tls.key_file).value(), server::ReadSmallFile(tls.certificate_file).value()}};
    server_credentials = grpc::SslServerCredentials(own);
    client_credentials = grpc::SslCredentials({server::ReadSmallFile(options.tls.ca_file).value(), "", ""});
  }
  grpc::ServerBuilder builder;
  builder.AddListeningPort("127.0.0.1:0", server_credentials, &port).RegisterService(&sink);
  const std::unique_ptr<grpc::Server> bare = builder.BuildAndStart();
  v1::ScanService::Stub stub(grpc::CreateChannel("127.0.0.1:" + std::to_string(port), client_credentials));

  server::LimitsConfig limits;
  limits.max_scan_points = 2 * kNumPoints;
  limits.max_scan_bytes = 2 * payload.size();
  limits.memory_bytes = 16 * payload.size();
  const bench::LoopbackService service(limits, tls);
  const std::unique_ptr<Client> client = service.Connect(options);

  SendBare(stub, payload);
  Upload(*client, scan);
  std::vector<std::pair<Cost, Cost>> rounds;
  for (int round = 0; round < kRounds; ++round) {
    const Cost of_bare = SendBare(stub, payload);
    rounds.emplace_back(of_bare, Upload(*client, scan));
  }
  Print(certificates == nullptr ? "plain text" : "TLS", rounds, payload.size());
}

int Main() {
  Scan scan;
  std::mt19937 random(1);
  std::uniform_real_distribution<float> coordinate(-50.0F, 50.0F);
  for (std::size_t i = 0; i < kNumPoints; ++i) {
    scan.points.emplace_back(coordinate(random), coordinate(random), coordinate(random));
  }
  const std::string payload(reinterpret_cast<const char*>(scan.points.data()), scan.points.size() * 12);

  Compare(nullptr, scan, payload);
  if (testing::HasOpenssl()) {
    const bench::ScratchFolder folder;
    const testing::Certificates certificates(folder.path());
    certificates.MakeAuthority("authority");
    certificates.MakeLeaf("server", "authority", "IP:127.0.0.1");
    Compare(&certificates, scan, payload);
  } else {
    std::printf("TLS left out: the openssl command is missing\n");
  }
  PrintOwnWork(payload);
  return 0;
}

}  // namespace
}  // namespace curvereg

int main() { return curvereg::Main(); }
