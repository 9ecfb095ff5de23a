// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The course of uploads over real connections: as they should go, resumed, many at once, idle.
#include "server/rpc/chunk_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <fstream>
#include <future>

#include "absl/strings/str_cat.h"
#include "core/scan/scan.h"
#include "tests/server/scans/scan_server.h"
#include "tests/testing/matchers.h"
#include "wire/point_codec.h"

namespace curvereg::testing {
namespace {

int NumThreads() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("Threads:")) return std::stoi(line.substr(8));
  }
  return 0;
}

TEST(UploadStream, StoresWhatWasSent) {
  ScanServer server;
  const auto stub = server.NewStub();
  const v1::PointCloud cloud = RandomCloud(20'000, 1);
  UploadClient client(*stub);
  ASSERT_TRUE(client.Send(StartMessage("a", cloud)));
  const auto ready = client.Receive();
  ASSERT_TRUE(ready.has_value() && ready->has_ready());
  EXPECT_EQ(ready->ready().committed_offset(), 0);
  EXPECT_EQ(ready->ready().max_chunk_bytes(), server::LimitsConfig().max_chunk_bytes);
  uint64_t told = 0;
  for (uint64_t offset = 0; offset < cloud.data().size(); offset += 50'000) {
    ASSERT_TRUE(client.Send(ChunkMessage(cloud, offset, 50'000)));
    const auto progress = client.Receive();
    ASSERT_TRUE(progress.has_value() && progress->has_progress());
    EXPECT_GT(progress->progress().committed_offset(), told);
    told = progress->progress().committed_offset();
  }
  EXPECT_EQ(told, cloud.data().size());
  ASSERT_TRUE(client.Send(FinishMessage()));
  ASSERT_THAT(client.End(), IsOk());
  ASSERT_TRUE(client.last().has_done());
  EXPECT_FALSE(client.last().done().already_stored());

  const v1::Scan& scan = client.last().done().scan();
  EXPECT_EQ(scan.header().SerializeAsString(), cloud.header().SerializeAsString());
  EXPECT_EQ(scan.payload_bytes(), cloud.data().size());
  EXPECT_EQ(scan.payload_digest().value(), Xxh3(cloud.data()).value());
  EXPECT_EQ(scan.finite_point_count(), 20'000);
  const absl::StatusOr<Scan> decoded = wire::DecodeScan(cloud.header(), cloud.data(), {});
  ASSERT_THAT(decoded, IsOk());
  EXPECT_EQ(scan.content_digest(), ScanDigest(*decoded));
  v1::DownloadScanRequest request;
  request.set_name(scan.name());
  EXPECT_EQ(Download(*stub, request).Bytes(), cloud.data());
  EXPECT_EQ(server.store().Statistics().num_uploads, 0);
  EXPECT_EQ(server.memory().reserved_bytes(), 0);
}

TEST(UploadStream, CountsPointsWithoutReturnApart) {
  ScanServer server;
  Scan scan;
  for (int i = 0; i < 200; ++i) scan.points.emplace_back(i, i % 7, i % 2 == 0 ? NAN : 1.0F);
  const auto cloud = wire::EncodeScan(scan);
  ASSERT_THAT(cloud, IsOk());
  const auto done = Upload(*server.NewStub(), "a", *cloud);
  ASSERT_THAT(done, IsOk());
  EXPECT_EQ(done->scan().finite_point_count(), 100);
  EXPECT_EQ(done->scan().header().point_count(), 200);
}

TEST(UploadStream, CountsWhatItDid) {
  ScanServer server;
  const auto stub = server.NewStub();
  const v1::PointCloud cloud = RandomCloud(1000, 1);
  SendAll(*stub, {StartMessage("a", cloud), ChunkMessage(cloud, 0, 6000)}).IgnoreError();
  ASSERT_THAT(Upload(*stub, "a", cloud, 3000), IsOk());
  EXPECT_EQ(MetricValue(server, "curvereg_uploads_resumed_total"), 1);
  EXPECT_EQ(MetricValue(server, "curvereg_uploads_completed_total"), 1);
  EXPECT_EQ(MetricValue(server, "curvereg_uploads_completed_bytes_total"), 12'000);
  EXPECT_EQ(MetricValue(server, "curvereg_received_scans_total"), 1);
  EXPECT_EQ(MetricValue(server, "curvereg_received_points_total"), 1000);
  EXPECT_EQ(MetricValue(server, "grpc_server_msg_received_total", "UploadScan"), 2 + 4);
}

TEST(UploadStream, GoesOnWhereItWasCut) {
  ScanServer server;
  const v1::PointCloud cloud = RandomCloud(20'000, 1);
  {
    const auto stub = server.NewStub();
    UploadClient client(*stub);
    client.Send(StartMessage("a", cloud));
    for (int i = 0; i < 3; ++i) client.Send(ChunkMessage(cloud, i * 50'000, 50'000));
    ASSERT_TRUE(client.ReceiveProgress(150'000));
    client.Cancel();
    EXPECT_THAT(client.End(), HasCode(absl::StatusCode::kCancelled));
  }
  const auto stub = server.NewStub();
  UploadClient client(*stub);
  client.Send(StartMessage("a", cloud));
  const auto ready = client.Receive();
  ASSERT_TRUE(ready.has_value() && ready->has_ready());
  EXPECT_EQ(ready->ready().committed_offset(), 150'000);
  client.Send(ChunkMessage(cloud, 150'000, 90'000));
  client.Send(FinishMessage());
  EXPECT_THAT(client.End(), IsOk());
  EXPECT_EQ(client.last().done().scan().payload_digest().value(), Xxh3(cloud.data()).value());
}

TEST(UploadStream, GoesOnAfterTheServerWasStarted) {
  ScanServer server;
  const v1::PointCloud cloud = RandomCloud(20'000, 1);
  {
    const auto stub = server.NewStub();
    UploadClient client(*stub);
    client.Send(StartMessage("a", cloud, false));
    client.Send(ChunkMessage(cloud, 0, 100'000));
    ASSERT_TRUE(client.ReceiveProgress(100'000));
    server.Restart();
    EXPECT_FALSE(client.End().ok());
  }
  EXPECT_EQ(CommittedBytes(server, "a"), 100'000);
  const auto stub = server.NewStub();
  EXPECT_THAT(SendAll(*stub, {StartMessage("a", cloud, false), ChunkMessage(cloud, 100'000, 140'000),
                              FinishMessage(Xxh3(cloud.data()))}),
              IsOk());
}

TEST(UploadStream, NeedsNoTransferOfWhatIsKnown) {
  ScanServer server;
  const auto stub = server.NewStub();
  const v1::PointCloud cloud = RandomCloud(1000, 1);
  const auto first = Upload(*stub, "a", cloud);
  ASSERT_THAT(first, IsOk());
  UploadClient client(*stub);
  client.Send(StartMessage("b", cloud));
  ASSERT_THAT(client.End(), IsOk());
  ASSERT_TRUE(client.last().has_done());
  EXPECT_TRUE(client.last().done().already_stored());
  EXPECT_EQ(client.last().done().scan().SerializeAsString(), first->scan().SerializeAsString());
  // The same bytes in another frame are another scan.
  v1::PointCloud other = cloud;
  other.mutable_header()->set_frame_id("mast");
  const auto third = Upload(*stub, "c", other);
  ASSERT_THAT(third, IsOk());
  EXPECT_FALSE(third->already_stored());
  EXPECT_NE(third->scan().name(), first->scan().name());
}

TEST(UploadStream, ForgetsTheRestOfAnUploadThatIsKnownMeanwhile) {
  ScanServer server;
  const auto stub = server.NewStub();
  const v1::PointCloud cloud = RandomCloud(1000, 1);
  SendAll(*stub, {StartMessage("a", cloud), ChunkMessage(cloud, 0, 6000)}).IgnoreError();
  ASSERT_THAT(Upload(*stub, "b", cloud), IsOk());
  const auto known = Upload(*stub, "a", cloud);
  ASSERT_THAT(known, IsOk());
  EXPECT_TRUE(known->already_stored());
  EXPECT_EQ(server.store().Statistics().num_uploads, 0);
  EXPECT_EQ(server.store().Statistics().stored_bytes, 12'000);
}

TEST(UploadStream, FindsAtFinishThatTheScanIsKnown) {
  ScanServer server;
  const auto stub = server.NewStub();
  const v1::PointCloud cloud = RandomCloud(1000, 1);
  ASSERT_THAT(Upload(*stub, "a", cloud), IsOk());
  UploadClient client(*stub);
  client.Send(StartMessage("b", cloud, false));
  client.Send(ChunkMessage(cloud, 0, 12'000));
  client.Send(FinishMessage(Xxh3(cloud.data())));
  ASSERT_THAT(client.End(), IsOk());
  EXPECT_TRUE(client.last().done().already_stored());
  EXPECT_EQ(server.store().Statistics().num_scans, 1);
  EXPECT_EQ(server.store().Statistics().num_uploads, 0);
}

// Each scan is forced to disk four times over, which together takes minutes where the disk is busy with other things.
TEST(UploadStream, RunsFiftyAtOnce) {
  ScanServer server;
  std::vector<std::future<absl::Status>> ends;
  for (int i = 0; i < 50; ++i) {
    ends.push_back(std::async(std::launch::async, [&server, i] {
      const auto stub = server.NewStub();
      const v1::PointCloud cloud = RandomCloud(5000, static_cast<uint64_t>(i + 1));
      const auto done = Upload(*stub, absl::StrCat("upload-", i), cloud, 7000);
      if (!done.ok()) return done.status();
      v1::DownloadScanRequest request;
      request.set_name(done->scan().name());
      const Downloaded downloaded = Download(*stub, request);
      if (!downloaded.status.ok()) return downloaded.status;
      return downloaded.Bytes() == cloud.data() ? absl::OkStatus() : absl::DataLossError("other bytes came back");
    }));
  }
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const absl::Status end = ends[i].get();
    const server::WorkerPoolStatistics disk = server.disk_pool().Statistics();
    EXPECT_THAT(end, IsOk()) << "upload-" << i << "; on the disk pool " << disk.num_running << " run and "
                             << disk.num_waiting << " wait; open are " << OpenCalls(server, "UploadScan")
                             << " uploads and " << OpenCalls(server, "DownloadScan") << " downloads";
  }
  EXPECT_EQ(server.store().Statistics().num_scans, 50);
  EXPECT_EQ(server.store().Statistics().num_uploads, 0);
}

TEST(UploadStream, HoldsNoThreadForAnIdleStream) {
  ScanServer server;
  const auto stub = server.NewStub();
  const v1::PointCloud cloud = RandomCloud(1000, 1);
  ASSERT_THAT(Upload(*stub, "warm", RandomCloud(100, 2)), IsOk());
  const int threads_before = NumThreads();
  std::vector<std::unique_ptr<UploadClient>> idle;
  for (int i = 0; i < 300; ++i) {
    idle.push_back(std::make_unique<UploadClient>(*stub));
    ASSERT_TRUE(idle.back()->Send(StartMessage(absl::StrCat("idle-", i), cloud)));
    ASSERT_TRUE(idle.back()->Receive().has_value());
    ASSERT_TRUE(idle.back()->Send(ChunkMessage(cloud, 0, 1000)));
  }
  EXPECT_LE(NumThreads(), threads_before + 16);  // gRPC's own
  EXPECT_THAT(Upload(*stub, "other", RandomCloud(5000, 3)), IsOk());
  EXPECT_EQ(OpenCalls(server, "UploadScan"), 300);
  idle.clear();
  EXPECT_TRUE(WaitUntil([&] { return OpenCalls(server, "UploadScan") == 0; }));
}

TEST(UploadStream, GoesOnForAClientThatReadsNoProgress) {
  ScanServer server;
  const auto stub = server.NewStub();
  const v1::PointCloud cloud = RandomCloud(20'000, 1);
  UploadClient client(*stub);
  client.Send(StartMessage("a", cloud));
  // 6000 answers, if each chunk had one, would not fit in a stream's window.
  for (uint64_t offset = 0; offset < cloud.data().size(); offset += 40) {
    ASSERT_TRUE(client.Send(ChunkMessage(cloud, offset, 40)));
  }
  client.Send(FinishMessage());
  const auto first = client.Receive();
  EXPECT_TRUE(first.has_value() && first->has_ready()) << "what came after it does not take its place";
  EXPECT_THAT(client.End(), IsOk());
  EXPECT_TRUE(client.last().has_done());
}

// The transport inside a process ends streams in another way than sockets do.
TEST(UploadStream, WorksWithinOneProcess) {
  ScanServer server;
  const auto stub = v1::ScanService::NewStub(server.server().InProcessChannel({}));
  const v1::PointCloud cloud = RandomCloud(20'000, 1);
  EXPECT_THAT(Upload(*stub, "a", cloud), IsOk());
  UploadClient open(*stub);  // does not half-close: a read is outstanding on the server when it refuses
  open.Send(FinishMessage());
  EXPECT_EQ(ReasonText(open.End()), "UNEXPECTED_MESSAGE");
  {
    UploadClient gone(*stub);
    gone.Send(StartMessage("b", RandomCloud(1000, 2)));
    gone.Receive();
  }
  EXPECT_TRUE(WaitUntil([&] { return OpenCalls(server, "UploadScan") == 0; }));
}

}  // namespace
}  // namespace curvereg::testing
