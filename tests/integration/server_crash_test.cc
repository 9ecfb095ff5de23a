// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// kill -9 at random moments of concurrent uploads and registrations: what was acknowledged is there afterwards, intact
// and once. CURVEREG_TEST_KILLS changes the number of moments.
#include <grpcpp/create_channel.h>

#include <atomic>
#include <cstdlib>
#include <map>
#include <mutex>
#include <random>
#include <set>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "curvereg/v1/registration_service.grpc.pb.h"
#include "curvereg/v1/scan_service.grpc.pb.h"
#include "tests/testing/patience.h"
#include "tests/testing/server_process.h"
#include "tests/testing/simulated.h"
#include "tests/testing/test_data.h"
#include "wire/digest.h"
#include "wire/point_codec.h"

namespace curvereg {
namespace {

constexpr int kUploaders = 3;
constexpr std::size_t kChunkBytes = 16 * 1024;

int NumKills() {
  const char* text = std::getenv("CURVEREG_TEST_KILLS");
  return text == nullptr ? 50 : std::atoi(text);
}

// One scan on its way, and what the server said of it.
struct Job {
  std::string upload;
  v1::PointCloud cloud;
  v1::Digest digest;
  uint64_t acknowledged = 0;  // greatest committed offset that an answer named
  std::string name;           // of the stored scan, once acknowledged
};

Job MakeJob(uint64_t number) {
  std::mt19937_64 random(number);
  std::uniform_real_distribution<float> coordinate(-20.0F, 20.0F);
  Scan scan;
  for (int i = 0; i < 20'000; ++i) scan.points.emplace_back(coordinate(random), coordinate(random), coordinate(random));
  Job job{.upload = "uploads/crash-" + std::to_string(number),
          .cloud = *wire::EncodeScan(scan),
          .digest = {},
          .acknowledged = 0,
          .name = {}};
  job.digest = wire::DigestOf(v1::DIGEST_ALGORITHM_XXH3_128, job.cloud.data());
  return job;
}

using Stream = grpc::ClientReaderWriter<v1::UploadScanRequest, v1::UploadScanResponse>;

// Reads until `done`, or until an answer brings the committed offset to `wanted`; notes what is acknowledged.
bool ReadUntil(Stream& stream, Job& job, uint64_t wanted) {
  v1::UploadScanResponse response;
  while (job.name.empty() && stream.Read(&response)) {
    if (response.has_done()) job.name = response.done().scan().name();
    if (response.has_ready()) job.acknowledged = std::max(job.acknowledged, response.ready().committed_offset());
    if (response.has_progress()) job.acknowledged = std::max(job.acknowledged, response.progress().committed_offset());
    if (response.has_ready() || job.acknowledged >= wanted) return true;
  }
  return !job.name.empty();
}

v1::UploadScanRequest StartOf(const Job& job) {
  v1::UploadScanRequest request;
  request.mutable_start()->set_upload(job.upload);
  *request.mutable_start()->mutable_header() = job.cloud.header();
  request.mutable_start()->set_payload_bytes(job.cloud.data().size());
  *request.mutable_start()->mutable_payload_digest() = job.digest;
  return request;
}

// Sends what is missing, chunk by chunk. False when the server went away first.
bool Upload(v1::ScanService::Stub& stub, Job& job) {
  grpc::ClientContext context;
  const auto stream = stub.UploadScan(&context);
  bool going = stream->Write(StartOf(job)) && ReadUntil(*stream, job, UINT64_MAX);
  for (uint64_t offset = job.acknowledged; going && job.name.empty() && offset < job.cloud.data().size();) {
    v1::UploadScanRequest request;
    request.mutable_chunk()->set_offset(offset);
    request.mutable_chunk()->set_data(job.cloud.data().substr(offset, kChunkBytes));
    request.mutable_chunk()->set_crc32c(wire::Crc32c(request.chunk().data()));
    offset += request.chunk().data().size();
    going = stream->Write(request) && ReadUntil(*stream, job, offset);
  }
  if (going && job.name.empty()) {
    v1::UploadScanRequest request;
    request.mutable_finish();
    going = stream->Write(request) && ReadUntil(*stream, job, UINT64_MAX);
  }
  stream->WritesDone();
  static_cast<void>(stream->Finish());
  return !job.name.empty();
}

std::string Download(v1::ScanService::Stub& stub, const std::string& name) {
  grpc::ClientContext context;
  v1::DownloadScanRequest request;
  request.set_name(name);
  const auto stream = stub.DownloadScan(&context, request);
  std::string payload;
  v1::DownloadScanResponse response;
  while (stream->Read(&response)) payload += response.chunk().data();
  EXPECT_TRUE(stream->Finish().ok());
  return payload;
}

class Crashes {
 public:
  Crashes() : server_(CURVEREG_SERVER_EXECUTABLE, folder_.path(), {}) {
    for (int i = 0; i < kUploaders; ++i) open_.push_back(MakeJob(next_job_++));
    const testing::ScanPairWithTruth pair = testing::PairOf("sparse", 1, 0);
    *request_.mutable_source()->mutable_inline_scan() = *wire::EncodeScan(pair.source);
    *request_.mutable_target()->mutable_inline_scan() = *wire::EncodeScan(pair.target);
  }

  // Works with the server until it is killed after `lifetime`, then starts it again and looks at what is there.
  void Round(std::chrono::milliseconds lifetime) {
    ASSERT_NE(server_.port(), 0) << "the server did not start; its log is in " << folder_.path();
    {
      std::vector<std::jthread> workers;
      for (Job& job : open_) workers.emplace_back([this, &job] { KeepUploading(job); });
      workers.emplace_back([this] { KeepRegistering(); });
      std::this_thread::sleep_for(lifetime);
      server_.Kill();
    }
    ASSERT_TRUE(server_.Restart());
    Check();
  }

  // Every payload byte of every scan that was acknowledged.
  void CheckAllBytes() {
    const auto stub = Scans();
    for (const Job& job : finished_) EXPECT_EQ(Download(*stub, job.name), job.cloud.data()) << job.name;
  }

  std::size_t num_finished() const { return finished_.size(); }
  int num_registered() const { return num_registered_; }

 private:
  std::shared_ptr<grpc::Channel> Channel() {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);  // not one that waits after an earlier refusal
    return grpc::CreateCustomChannel(server_.target(), grpc::InsecureChannelCredentials(), arguments);
  }
  std::unique_ptr<v1::ScanService::Stub> Scans() { return v1::ScanService::NewStub(Channel()); }

  void KeepUploading(Job& job) {
    const auto stub = Scans();
    while (Upload(*stub, job)) {
      const std::lock_guard lock(mutex_);
      finished_.push_back(std::move(job));
      job = MakeJob(next_job_++);
    }
  }

  void KeepRegistering() {
    const auto stub = v1::RegistrationService::NewStub(Channel());
    while (true) {
      grpc::ClientContext context;
      v1::RegisterScansResponse response;
      if (!stub->RegisterScans(&context, request_, &response).ok()) return;
      ++num_registered_;
      EXPECT_TRUE(response.result().verdict().accepted());
    }
  }

  void Check() {
    const auto stub = Scans();
    std::map<std::string, int> listed;
    v1::ListScansRequest request;
    v1::ListScansResponse page;
    do {
      grpc::ClientContext context;
      page.Clear();
      ASSERT_TRUE(stub->ListScans(&context, request, &page).ok());
      for (const v1::Scan& scan : page.scans()) ++listed[scan.name()];
      request.set_page_token(page.next_page_token());
    } while (!page.next_page_token().empty());
    for (const auto& [name, times] : listed) EXPECT_EQ(times, 1) << name;
    for (const Job& job : finished_) EXPECT_EQ(listed[job.name], 1) << job.name << " was acknowledged";
    for (const Job& job : open_) CheckUpload(*stub, job);
    if (!finished_.empty()) {
      EXPECT_EQ(Download(*stub, finished_.back().name), finished_.back().cloud.data());
    }
  }

  // Its bytes are there; or it was finished, and only the answer was lost.
  void CheckUpload(v1::ScanService::Stub& stub, const Job& job) {
    if (job.acknowledged == 0) return;
    grpc::ClientContext context;
    v1::GetUploadRequest request;
    request.set_upload(job.upload);
    v1::GetUploadResponse response;
    const grpc::Status status = stub.GetUpload(&context, request, &response);
    if (status.ok()) {
      EXPECT_GE(response.committed_offset(), job.acknowledged) << job.upload;
    } else {
      EXPECT_EQ(status.error_code(), grpc::StatusCode::NOT_FOUND);
      EXPECT_EQ(job.acknowledged, job.cloud.data().size()) << job.upload << " is gone";
    }
  }

  testing::TemporaryFolder folder_;
  testing::ServerProcess server_;
  std::vector<Job> open_;
  std::mutex mutex_;
  std::vector<Job> finished_;
  std::atomic<uint64_t> next_job_ = 0;
  std::atomic<int> num_registered_ = 0;
  v1::RegisterScansRequest request_;
};

TEST(ServerCrashTest, WhatWasAcknowledgedIsThereAfterKill9) {
  Crashes crashes;
  std::mt19937 random(20261122);
  std::uniform_int_distribution<int> lifetime_ms(5, 250 * testing::kPatience);  // some registrations end
  for (int i = 0; i < NumKills(); ++i) {
    SCOPED_TRACE(i);
    ASSERT_NO_FATAL_FAILURE(crashes.Round(std::chrono::milliseconds(lifetime_ms(random))));
    if (::testing::Test::HasFailure()) return;
  }
  crashes.CheckAllBytes();
  std::printf("%d kills, %zu scans acknowledged, %d registrations\n", NumKills(), crashes.num_finished(),
              crashes.num_registered());
  EXPECT_GT(crashes.num_finished(), 0U);
  EXPECT_GT(crashes.num_registered(), 0);
}

}  // namespace
}  // namespace curvereg
