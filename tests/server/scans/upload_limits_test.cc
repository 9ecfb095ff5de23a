// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Uploads that ask for more than the server gives: limits of size, memory and store, and payloads that lie about what
// they decode to.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zstd.h>

#include <fstream>

#include "tests/server/scans/scan_server.h"
#include "tests/testing/matchers.h"
#include "wire/point_codec.h"

namespace curvereg::testing {
namespace {

// `size` zeros as one zstd frame that tells its size or does not, without holding them.
std::string ZeroFrame(uint64_t size, bool tell_size) {
  ZSTD_CCtx* const context = ZSTD_createCCtx();
  if (tell_size) ZSTD_CCtx_setPledgedSrcSize(context, size);
  const std::string zeros(1 << 20, '\0');
  std::string frame(1 << 20, '\0');
  ZSTD_outBuffer out{frame.data(), frame.size(), 0};
  for (uint64_t done = 0; done < size; done += zeros.size()) {
    ZSTD_inBuffer in{zeros.data(), zeros.size(), 0};
    const bool is_last = done + zeros.size() >= size;
    while (ZSTD_compressStream2(context, &out, &in, is_last ? ZSTD_e_end : ZSTD_e_continue) != 0 && is_last) {
    }
  }
  ZSTD_freeCCtx(context);
  frame.resize(out.pos);
  return frame;
}

// Peak of resident memory since ResetPeak [bytes].
uint64_t PeakBytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmHWM:")) return std::stoull(line.substr(6)) << 10;
  }
  return 0;
}
void ResetPeak() { std::ofstream("/proc/self/clear_refs") << "5"; }

TEST(UploadLimits, DecompressesNoMoreThanTheHeaderDeclares) {
  ScanServer server;
  const auto stub = server.NewStub();
  v1::PointCloud cloud = RandomCloud(1000, 1);
  cloud.mutable_header()->set_encoding(v1::POINT_ENCODING_SHUFFLED_ZSTD);
  for (const bool tell_size : {true, false}) {
    cloud.set_data(ZeroFrame(uint64_t{1} << 30, tell_size));
    ASSERT_LT(cloud.data().size(), 1 << 20);
    ResetPeak();
    const uint64_t before = PeakBytes();
    EXPECT_EQ(ReasonText(Upload(*stub, "bomb", cloud).status()), "MALFORMED_PAYLOAD");
    EXPECT_LT(PeakBytes() - before, uint64_t{64} << 20);
  }
}

TEST(UploadLimits, TakesNoMemoryForSizesThatAreOnlyTold) {
  ScanServer server;
  const auto stub = server.NewStub();
  v1::PointCloud cloud = RandomCloud(100, 1);
  ResetPeak();
  const uint64_t before = PeakBytes();
  v1::UploadScanRequest start = StartMessage("a", cloud, false);
  start.mutable_start()->mutable_header()->set_point_count(10'000'000);
  start.mutable_start()->set_payload_bytes(120'000'000);
  const absl::Status status = SendAll(*stub, {start, ChunkMessage(cloud, 0, 1200), FinishMessage(Xxh3(cloud.data()))});
  EXPECT_EQ(MetadataOf(status, "committed_offset"), "1200");
  EXPECT_LT(PeakBytes() - before, uint64_t{32} << 20);
}

TEST(UploadLimits, RefusesScansBeyondTheLimits) {
  ScanServerOptions options;
  options.limits.max_scan_points = 1000;
  options.limits.max_scan_bytes = 6000;
  ScanServer server(options);
  const auto stub = server.NewStub();
  EXPECT_THAT(Upload(*stub, "a", RandomCloud(500, 1)), IsOk());
  const absl::Status bytes = Upload(*stub, "b", RandomCloud(501, 1)).status();
  EXPECT_EQ(ReasonText(bytes), "SCAN_TOO_LARGE") << bytes;
  EXPECT_EQ(MetadataOf(bytes, "limit"), "6000");
  EXPECT_EQ(MetadataOf(bytes, "value"), "6012");
  v1::PointCloud many = RandomCloud(100, 1);
  many.mutable_header()->set_point_count(1001);
  many.mutable_header()->set_encoding(v1::POINT_ENCODING_SHUFFLED_ZSTD);
  const absl::Status points = Upload(*stub, "c", many).status();
  EXPECT_EQ(ReasonText(points), "SCAN_TOO_LARGE") << points;
  EXPECT_EQ(MetadataOf(points, "limit"), "1000");
  EXPECT_EQ(server.store().Statistics().num_uploads, 0);
}

TEST(UploadLimits, SaysAtStartThatMemoryWouldNeverDo) {
  ScanServerOptions options;
  options.memory_bytes = 1000;
  ScanServer server(options);
  const absl::Status status = Upload(*server.NewStub(), "a", RandomCloud(100, 1)).status();
  EXPECT_EQ(ReasonText(status), "SCAN_TOO_LARGE");
  EXPECT_EQ(MetadataOf(status, "limit"), "1000");
  EXPECT_EQ(server.store().Statistics().num_uploads, 0);
}

TEST(UploadLimits, CanFinishLaterWhenMemoryIsShort) {
  ScanServer server;
  const auto stub = server.NewStub();
  // Packed bytes must be decoded at the end; plain floats are looked at as they come.
  const v1::PointCloud plain = RandomCloud(100, 1);
  const Scan scan = *wire::DecodeScan(plain.header(), plain.data(), {});
  const v1::PointCloud cloud =
      *wire::EncodeScan(scan, {.encoding = v1::POINT_ENCODING_SHUFFLED_ZSTD, .max_error_m = 1e-3, .zstd_level = 1});
  const uint64_t size = cloud.data().size();
  {
    const auto all = server.memory().Reserve(server.memory().total_bytes());
    ASSERT_THAT(all, IsOk());
    UploadClient client(*stub);
    client.Send(StartMessage("a", cloud));
    client.Send(ChunkMessage(cloud, 0, size));
    client.Send(FinishMessage());
    const absl::Status status = client.End();
    EXPECT_EQ(ReasonText(status), "MEMORY_BUDGET");
    EXPECT_TRUE(wire::RetryDelayOf(status).has_value());
    EXPECT_TRUE(client.context().GetServerTrailingMetadata().contains("grpc-retry-pushback-ms"));
  }
  EXPECT_EQ(CommittedBytes(server, "a"), size);
  EXPECT_THAT(SendAll(*stub, {StartMessage("a", cloud), FinishMessage()}), IsOk());
}

TEST(UploadLimits, RefusesAnotherScanUnderTheNameOfAnUpload) {
  ScanServer server;
  const auto stub = server.NewStub();
  const v1::PointCloud cloud = RandomCloud(100, 1);
  SendAll(*stub, {StartMessage("a", cloud), ChunkMessage(cloud, 0, 100)}).IgnoreError();
  EXPECT_EQ(ReasonText(Upload(*stub, "a", RandomCloud(101, 2)).status()), "UPLOAD_DIFFERS");
  EXPECT_EQ(CommittedBytes(server, "a"), 100);
}

TEST(UploadLimits, RefusesMoreThanTheStoreTakes) {
  ScanServerOptions options;
  options.store.max_uploads = 1;
  options.store.max_stored_bytes = 2000;
  ScanServer server(options);
  const auto stub = server.NewStub();
  const v1::PointCloud cloud = RandomCloud(100, 1);
  EXPECT_EQ(ReasonText(Upload(*stub, "big", RandomCloud(200, 1)).status()), "STORAGE_FULL");
  SendAll(*stub, {StartMessage("a", cloud), ChunkMessage(cloud, 0, 100)}).IgnoreError();
  const absl::Status second = Upload(*stub, "b", RandomCloud(10, 2)).status();
  EXPECT_EQ(ReasonText(second), "TOO_MANY_UPLOADS");
  EXPECT_EQ(MetricValue(server, "curvereg_rejected_total", "\"STORAGE_FULL\""), 1);
  EXPECT_EQ(MetricValue(server, "curvereg_rejected_total", "\"TOO_MANY_UPLOADS\""), 1);
  EXPECT_TRUE(wire::RetryDelayOf(second).has_value());
  EXPECT_THAT(Upload(*stub, "a", cloud), IsOk()) << "the one that is open goes on";
}

}  // namespace
}  // namespace curvereg::testing
