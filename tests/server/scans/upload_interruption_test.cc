// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Upload streams that end otherwise than by done: taken over, left by their clients, out of time, drained.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <future>

#include "absl/strings/str_cat.h"
#include "tests/server/scans/scan_server.h"
#include "tests/server/scheduling/busy_worker.h"
#include "tests/testing/matchers.h"

namespace curvereg::testing {
namespace {

TEST(UploadInterruption, IsTakenOverBySecondStream) {
  ScanServer server;
  const auto stub = server.NewStub();
  const v1::PointCloud cloud = RandomCloud(1000, 1);
  UploadClient first(*stub);
  first.Send(StartMessage("a", cloud));
  first.Send(ChunkMessage(cloud, 0, 6000));
  ASSERT_TRUE(first.ReceiveProgress(6000));
  // The first one is idle, and told all the same.
  UploadClient second(*stub);
  second.Send(StartMessage("a", cloud));
  const auto ready = second.Receive();
  ASSERT_TRUE(ready.has_value() && ready->has_ready());
  EXPECT_EQ(ready->ready().committed_offset(), 6000);
  const absl::Status replaced = first.End();
  EXPECT_THAT(replaced, HasCode(absl::StatusCode::kAborted));
  EXPECT_EQ(ReasonText(replaced), "WRITER_REPLACED");
  second.Send(ChunkMessage(cloud, 6000, 6000));
  second.Send(FinishMessage());
  EXPECT_THAT(second.End(), IsOk());
}

TEST(UploadInterruption, SurvivesManyTakeoversAtOnce) {
  ScanServer server;
  const v1::PointCloud cloud = RandomCloud(20'000, 1);
  std::vector<std::future<std::string>> ends;
  for (int i = 0; i < 8; ++i) {
    ends.push_back(std::async(std::launch::async, [&server, &cloud] {
      return ReasonText(Upload(*server.NewStub(), "a", cloud, 10'000).status());
    }));
  }
  int num_done = 0;
  for (std::future<std::string>& end : ends) {
    const std::string reason = end.get();
    EXPECT_THAT(reason, ::testing::AnyOf("OK", "WRITER_REPLACED"));
    num_done += reason == "OK" ? 1 : 0;
  }
  EXPECT_GE(num_done, 1);
  EXPECT_EQ(server.store().Statistics().num_scans, 1);
  EXPECT_TRUE(WaitUntil([&] { return OpenCalls(server, "UploadScan") == 0; }));
}

TEST(UploadInterruption, OutlivesClientsThatDisappearInAnyState) {
  ScanServer server;
  const v1::PointCloud cloud = RandomCloud(20'000, 1);
  const std::vector<std::function<void(UploadClient&, const std::string&)>> lives = {
      [](UploadClient&, const std::string&) {},
      [&](UploadClient& c, const std::string& upload) { c.Send(StartMessage(upload, cloud)); },
      [&](UploadClient& c, const std::string& upload) {
        c.Send(StartMessage(upload, cloud));
        c.Receive();
      },
      [&](UploadClient& c, const std::string& upload) {
        c.Send(StartMessage(upload, cloud));
        for (int i = 0; i < 4; ++i) c.Send(ChunkMessage(cloud, i * 50'000, 50'000));
      },
      [&](UploadClient& c, const std::string& upload) {
        c.Send(StartMessage(upload, cloud));
        c.Send(ChunkMessage(cloud, 0, 1000));
        c.ReceiveProgress(1000);
        c.HalfClose();
      },
      [&](UploadClient& c, const std::string& upload) {
        c.Send(StartMessage(upload, cloud));
        c.Send(ChunkMessage(cloud, 0, 240'000));
        c.Send(FinishMessage());
      },
  };
  for (int round = 0; round < 5; ++round) {
    for (size_t i = 0; i < lives.size(); ++i) {
      const auto stub = server.NewStub();
      UploadClient client(*stub);
      lives[i](client, absl::StrCat("life-", i));
    }
  }
  EXPECT_TRUE(WaitUntil([&] { return OpenCalls(server, "UploadScan") == 0; }));
  EXPECT_EQ(server.memory().reserved_bytes(), 0);
  for (size_t i = 0; i < lives.size(); ++i) {
    EXPECT_THAT(Upload(*server.NewStub(), absl::StrCat("life-", i), cloud), IsOk());
  }
}

TEST(UploadInterruption, EndsAtTheDeadlineOfTheCaller) {
  ScanServer server;
  const auto stub = server.NewStub();
  UploadClient client(*stub, std::chrono::milliseconds(100));
  client.Send(StartMessage("a", RandomCloud(1000, 1)));
  EXPECT_THAT(client.End(), HasCode(absl::StatusCode::kDeadlineExceeded));
  EXPECT_TRUE(WaitUntil([&] { return OpenCalls(server, "UploadScan") == 0; }));
}

TEST(UploadInterruption, LetsGoOfIdleStreamsWhenTheServerDrains) {
  ScanServer server;
  const auto stub = server.NewStub();
  const v1::PointCloud cloud = RandomCloud(1000, 1);
  UploadClient silent(*stub);
  UploadClient idle(*stub);
  idle.Send(StartMessage("a", cloud));
  idle.Send(ChunkMessage(cloud, 0, 6000));
  ASSERT_TRUE(idle.ReceiveProgress(6000));
  ASSERT_TRUE(WaitUntil([&] { return OpenCalls(server, "UploadScan") == 2; }));
  server.Drain();
  EXPECT_EQ(ReasonText(silent.End()), "NOT_SERVING");
  EXPECT_EQ(ReasonText(idle.End()), "NOT_SERVING");
  EXPECT_EQ(CommittedBytes(server, "a"), 6000);
  EXPECT_EQ(ReasonText(Upload(*stub, "b", cloud).status()), "NOT_SERVING");
}

TEST(UploadInterruption, EndsAtTheServersEndWhileItsTaskWaits) {
  ScanServerOptions options;
  options.disk_pool = {.num_workers = 1, .max_queue_length = 2, .max_queue_per_client = 2};
  ScanServer server(options);
  const auto stub = server.NewStub();
  BusyWorker busy(server.disk_pool());
  UploadClient upload(*stub);
  upload.Send(StartMessage("a", RandomCloud(1000, 1)));
  ASSERT_TRUE(WaitUntil([&] { return server.disk_pool().Statistics().num_waiting == 1; }));
  server.EndCalls();
  EXPECT_EQ(ReasonText(upload.End()), "NOT_SERVING");
  busy.LetGo();
}

// Tasks that wait for the disk, held up by one that keeps the only worker.
TEST(UploadInterruption, EndsWhileItsTaskWaits) {
  ScanServerOptions options;
  options.disk_pool = {.num_workers = 1, .max_queue_length = 2, .max_queue_per_client = 2};
  ScanServer server(options);
  const auto stub = server.NewStub();
  BusyWorker busy(server.disk_pool());
  const v1::PointCloud cloud = RandomCloud(1000, 1);
  {
    UploadClient gone(*stub);
    gone.Send(StartMessage("a", cloud));
    ASSERT_TRUE(WaitUntil([&] { return server.disk_pool().Statistics().num_waiting == 1; }));
  }
  EXPECT_TRUE(WaitUntil([&] { return OpenCalls(server, "UploadScan") == 0; })) << "no need to wait for its turn";
  EXPECT_EQ(server.disk_pool().Statistics().num_waiting, 0);

  UploadClient one(*stub);
  UploadClient two(*stub);
  one.Send(StartMessage("a", cloud));
  two.Send(StartMessage("b", cloud));
  ASSERT_TRUE(WaitUntil([&] { return server.disk_pool().Statistics().num_waiting == 2; }));
  const absl::Status refused = Upload(*stub, "c", cloud).status();
  EXPECT_THAT(refused, HasCode(absl::StatusCode::kResourceExhausted));
  EXPECT_TRUE(wire::RetryDelayOf(refused).has_value());
  busy.LetGo();
  EXPECT_TRUE(one.Receive().has_value());
  EXPECT_TRUE(two.Receive().has_value());
}

}  // namespace
}  // namespace curvereg::testing
