// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/scans/download_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <thread>

#include "tests/server/scans/scan_server.h"
#include "tests/testing/matchers.h"
#include "wire/digest.h"
#include "wire/status_mapping.h"

namespace curvereg::testing {
namespace {

// A server with one scan of 20,000 points, 240,000 bytes.
class DownloadStream : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto done = Upload(*stub_, "a", cloud_);
    ASSERT_THAT(done, IsOk());
    scan_ = done->scan();
    request_.set_name(scan_.name());
  }

  static ScanServerOptions Options() {
    ScanServerOptions options;
    options.limits.max_chunk_bytes = 100'000;
    return options;
  }

  ScanServer server_{Options()};
  std::unique_ptr<v1::ScanService::Stub> stub_ = server_.NewStub();
  v1::PointCloud cloud_ = RandomCloud(20'000, 1);
  v1::Scan scan_;
  v1::DownloadScanRequest request_;
};

TEST_F(DownloadStream, GivesTheScanAndThenItsBytesInOrder) {
  request_.set_chunk_bytes(70'000);
  const Downloaded downloaded = Download(*stub_, request_);
  ASSERT_THAT(downloaded.status, IsOk());
  ASSERT_TRUE(downloaded.scan.has_value());
  EXPECT_EQ(downloaded.scan->SerializeAsString(), scan_.SerializeAsString());
  ASSERT_EQ(downloaded.chunks.size(), 4);
  uint64_t offset = 0;
  for (const v1::PayloadChunk& chunk : downloaded.chunks) {
    EXPECT_EQ(chunk.offset(), offset);
    EXPECT_TRUE(chunk.has_crc32c());
    EXPECT_EQ(chunk.crc32c(), wire::Crc32c(chunk.data()));
    offset += chunk.data().size();
  }
  EXPECT_EQ(downloaded.Bytes(), cloud_.data());
}

TEST_F(DownloadStream, CutsChunksToTheLimit) {
  for (const uint32_t wanted : {0U, 100'000U, 100'001U, 4'000'000'000U}) {
    request_.set_chunk_bytes(wanted);
    const Downloaded downloaded = Download(*stub_, request_);
    EXPECT_THAT(downloaded.status, IsOk());
    ASSERT_EQ(downloaded.chunks.size(), 3);
    EXPECT_EQ(downloaded.chunks[0].data().size(), 100'000);
  }
  request_.set_chunk_bytes(99'999);
  EXPECT_EQ(Download(*stub_, request_).chunks[0].data().size(), 99'999);
}

TEST_F(DownloadStream, GoesOnFromAnyOffset) {
  for (const uint64_t offset : {1, 12, 99'999, 100'000, 100'001, 239'999, 240'000}) {
    SCOPED_TRACE(offset);
    request_.set_offset(offset);
    const Downloaded downloaded = Download(*stub_, request_);
    EXPECT_THAT(downloaded.status, IsOk());
    EXPECT_TRUE(downloaded.scan.has_value());
    EXPECT_EQ(downloaded.Bytes(), cloud_.data().substr(offset));
    EXPECT_EQ(downloaded.chunks.empty(), offset == 240'000);
    if (downloaded.chunks.empty()) continue;
    EXPECT_EQ(downloaded.chunks[0].offset(), offset);
  }
}

TEST_F(DownloadStream, RefusesAnOffsetBeyondTheEnd) {
  for (const uint64_t offset : {uint64_t{240'001}, ~uint64_t{0}}) {
    request_.set_offset(offset);
    const Downloaded downloaded = Download(*stub_, request_);
    EXPECT_EQ(ReasonText(downloaded.status), "OFFSET_OUT_OF_RANGE");
    EXPECT_FALSE(downloaded.scan.has_value());
  }
}

TEST_F(DownloadStream, RefusesNamesThatAreNone) {
  request_.set_name("scans/" + std::string(32, '0'));
  EXPECT_EQ(ReasonText(Download(*stub_, request_).status), "SCAN_NOT_FOUND");
  for (const std::string& name : {std::string(), std::string("scans/"), "uploads/" + std::string(32, '0'),
                                  "scans/" + std::string(31, '0'), "scans/" + std::string(31, '0') + "A"}) {
    request_.set_name(name);
    EXPECT_EQ(ReasonText(Download(*stub_, request_).status), "INVALID_FIELD") << name;
  }
}

// The one file of payload in the store's folder: the one of the payload's size.
std::filesystem::path PayloadFile(const ScanServer& server, uint64_t size) {
  for (const auto& entry : std::filesystem::recursive_directory_iterator(server.folder())) {
    if (entry.is_regular_file() && entry.file_size() == size) return entry.path();
  }
  return {};
}

// Changes some bytes of the one payload that has this size.
void DamagePayload(const ScanServer& server, uint64_t size) {
  const std::filesystem::path file = PayloadFile(server, size);
  ASSERT_FALSE(file.empty());
  std::filesystem::permissions(file, std::filesystem::perms::owner_write, std::filesystem::perm_options::add);
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  stream.seekp(1000);
  stream.put('\x55').put('\x55').put('\x55').put('\x55');
  ASSERT_TRUE(stream.good());
}

TEST_F(DownloadStream, TellsThatBytesWereDamagedAndGivesNoEnd) {
  DamagePayload(server_, 240'000);
  const Downloaded downloaded = Download(*stub_, request_);
  EXPECT_EQ(ReasonText(downloaded.status), "STORED_SCAN_DAMAGED");
  EXPECT_LT(downloaded.Bytes().size(), 240'000);
}

TEST_F(DownloadStream, DamageThatItFoundIsMendedByUploadingAgain) {
  DamagePayload(server_, 240'000);
  EXPECT_EQ(ReasonText(Download(*stub_, request_).status), "STORED_SCAN_DAMAGED");
  EXPECT_EQ(server_.store().DamagedScans().size(), 1U);
  EXPECT_THAT(Upload(*stub_, "again", cloud_), IsOk());
  EXPECT_TRUE(server_.store().DamagedScans().empty());
  const Downloaded downloaded = Download(*stub_, request_);
  EXPECT_THAT(downloaded.status, IsOk());
  EXPECT_EQ(downloaded.Bytes(), cloud_.data());
}

// Also where the damage lies before the first byte that is wanted: it may have been sent to this client.
TEST_F(DownloadStream, ADownloadThatGoesOnTellsOfDamage) {
  for (const uint64_t offset : {500, 150'000, 240'000}) {
    SCOPED_TRACE(offset);
    DamagePayload(server_, 240'000);
    request_.set_offset(offset);
    const Downloaded downloaded = Download(*stub_, request_);
    EXPECT_EQ(ReasonText(downloaded.status), "STORED_SCAN_DAMAGED");
    EXPECT_LT(downloaded.Bytes().size(), std::max<uint64_t>(1, 240'000 - offset));
    EXPECT_EQ(server_.store().DamagedScans().size(), 1U);
    EXPECT_THAT(Upload(*stub_, "again" + std::to_string(offset), cloud_), IsOk());
  }
}

TEST_F(DownloadStream, GoesOnFarBehindTheBegin) {
  const v1::PointCloud large = RandomCloud(2'000'000, 3);  // 24 MB: read in several turns
  const auto done = Upload(*stub_, "large", large, 100'000);
  ASSERT_THAT(done, IsOk());
  request_.set_name(done->scan().name());
  for (const uint64_t offset : {large.data().size() - 150'000, large.data().size()}) {
    request_.set_offset(offset);
    const Downloaded downloaded = Download(*stub_, request_);
    EXPECT_THAT(downloaded.status, IsOk());
    EXPECT_EQ(downloaded.Bytes(), large.data().substr(offset));
  }
}

TEST_F(DownloadStream, ReadsNoFurtherThanTheClientDoes) {
  const v1::PointCloud large = RandomCloud(2'000'000, 2);  // 24 MB: more than the windows of a stream
  const auto done = Upload(*stub_, "large", large, 100'000);
  ASSERT_THAT(done, IsOk());
  request_.set_name(done->scan().name());
  const auto slow_stub = server_.NewStub();
  grpc::ClientContext context;
  const auto stream = slow_stub->DownloadScan(&context, request_);
  v1::DownloadScanResponse response;
  ASSERT_TRUE(stream->Read(&response));
  const double before = MetricValue(server_, "grpc_server_msg_sent_total", "DownloadScan");
  // Nobody reads on: the server comes to rest with a window's worth sent, and holds no worker.
  ASSERT_TRUE(WaitUntil([&] { return server_.disk_pool().Statistics().num_running == 0; }));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_LT(MetricValue(server_, "grpc_server_msg_sent_total", "DownloadScan") - before, 200);
  EXPECT_EQ(server_.disk_pool().Statistics().num_running, 0);
  std::string bytes;
  while (stream->Read(&response)) bytes += response.chunk().data();
  EXPECT_THAT(wire::FromGrpcStatus(stream->Finish()), IsOk());
  EXPECT_EQ(bytes, large.data());
}

TEST_F(DownloadStream, OutlivesAClientThatLeaves) {
  request_.set_chunk_bytes(100);
  for (int messages = 0; messages < 4; ++messages) {
    const auto stub = server_.NewStub();
    grpc::ClientContext context;
    const auto stream = stub->DownloadScan(&context, request_);
    v1::DownloadScanResponse response;
    for (int i = 0; i < messages; ++i) ASSERT_TRUE(stream->Read(&response));
    context.TryCancel();
    while (stream->Read(&response)) {
    }
    EXPECT_EQ(stream->Finish().error_code(), grpc::StatusCode::CANCELLED);
  }
  EXPECT_TRUE(WaitUntil([&] { return OpenCalls(server_, "DownloadScan") == 0; }));
}

TEST_F(DownloadStream, IsRefusedWhileTheServerDrains) {
  server_.Drain();
  EXPECT_EQ(ReasonText(Download(*stub_, request_).status), "NOT_SERVING");
}

}  // namespace
}  // namespace curvereg::testing
