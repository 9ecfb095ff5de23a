// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Streams of scans that end at every possible moment.
#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/traverses.h"
#include "tests/client/fake_traverse_server.h"
#include "tests/client/scripted_server.h"
#include "tests/testing/impairment_proxy.h"
#include "tests/testing/scenes.h"

namespace curvereg {
namespace {

using std::chrono::milliseconds;
using testing::ConnectTo;
using testing::FakeTraverseServer;
using testing::ImpairmentProxy;
using testing::QuickOptions;
using testing::Refusal;
using testing::TraverseMemory;
using Clock = std::chrono::steady_clock;

constexpr char kName[] = "traverses/drive";

StreamedScan ScanNumber(uint64_t number) {
  StreamedScan scan;
  scan.sequence_number = number;
  scan.scan.points = testing::PatchPoints({.side_m = 20, .noise_m = 0.3}, 1500, 100 + number);
  scan.time_ns = static_cast<int64_t>(1'700'000'000'000'000'000 + number);
  return scan;
}

// What a caller is told.
struct Diary {
  std::vector<uint64_t> results;
  std::vector<uint64_t> acknowledged;
  StreamProgress progress;

  StreamOptions Options() {
    StreamOptions options;
    options.chunk_bytes = 2000;
    options.on_result = [this](const ScanResult& result) { results.push_back(result.sequence_number); };
    options.on_acknowledged = [this](uint64_t number, const std::string&) { acknowledged.push_back(number); };
    options.on_progress = [this](const StreamProgress& now) { progress = now; };
    return options;
  }
};

std::vector<uint64_t> Numbers(uint64_t begin, uint64_t end) {
  std::vector<uint64_t> numbers;
  for (uint64_t i = begin; i < end; ++i) numbers.push_back(i);
  return numbers;
}

absl::Status StreamAll(Client& client, const StreamOptions& options, uint64_t begin, uint64_t end) {
  auto streamer = client.traverses().Stream(kName, options);
  if (!streamer.ok()) return streamer.status();
  for (uint64_t i = begin; i < end; ++i) {
    if (absl::Status sent = (*streamer)->Send(ScanNumber(i)); !sent.ok()) return sent;
  }
  return (*streamer)->Finish();
}

TEST(TraverseStreamTest, BringsScansOverAndResultsBack) {
  TraverseMemory memory;
  const FakeTraverseServer server(memory);
  Diary diary;
  const auto client = ConnectTo(server.target());
  StreamOptions options = diary.Options();
  auto streamer = client->traverses().Stream(kName, options);
  ASSERT_TRUE(streamer.ok());
  StreamedScan first = ScanNumber(0);
  first.frame_id = "mast";
  first.prior = Prior{.T_target_source = testing::UprightPose(1, 2, 0.3), .covariance = Matrix6d::Identity()};
  ASSERT_TRUE((*streamer)->Send(first).ok());
  ASSERT_TRUE((*streamer)->Send(ScanNumber(1)).ok());
  EXPECT_TRUE(absl::IsInvalidArgument((*streamer)->Send(ScanNumber(3)))) << "a gap";
  EXPECT_FALSE((*streamer)->ended().stop_requested());
  const absl::Status finished = (*streamer)->Finish();
  EXPECT_TRUE((*streamer)->ended().stop_requested());
  EXPECT_TRUE(finished.ok()) << finished;
  EXPECT_FALSE((*streamer)->Send(ScanNumber(2)).ok()) << "after Finish";
  EXPECT_EQ(diary.results, Numbers(0, 2));
  EXPECT_EQ(diary.acknowledged, Numbers(0, 2));
  EXPECT_EQ(diary.progress.num_acknowledged, 2U);
  EXPECT_EQ(diary.progress.bytes_resent, 0U);
  EXPECT_EQ(diary.progress.bytes_sent, memory.bytes_received);
  EXPECT_EQ(diary.progress.bytes_acknowledged, memory.bytes_received);
  ASSERT_EQ(memory.scans.size(), 2U);
  EXPECT_EQ(memory.scans[0].header().frame_id(), "mast");
  EXPECT_EQ(memory.scans[0].header().time().seconds(), 1'700'000'000);
  EXPECT_EQ(memory.scans[0].prior().covariance().upper_triangle_size(), 21);
  EXPECT_FALSE(memory.scans[1].has_prior());
  EXPECT_EQ(memory.scans[1].header().time().nanos(), 1);
}

TEST(TraverseStreamTest, EveryScanOnceWhereverTheServerCutsItsReading) {
  for (int cut_after = 1; cut_after <= 12; ++cut_after) {
    TraverseMemory memory;
    memory.cut_after_received = cut_after;
    // A stream that gets but one message makes no progress; every third is left alone.
    memory.on_start = [&memory, cut_after](int num_streams) {
      memory.cut_after_received = num_streams % 3 == 0 ? 0 : cut_after;
      return grpc::Status::OK;
    };
    const FakeTraverseServer server(memory);
    Diary diary;
    const absl::Status status = StreamAll(*ConnectTo(server.target()), diary.Options(), 0, 6);
    ASSERT_TRUE(status.ok()) << cut_after << ": " << status;
    EXPECT_EQ(diary.results, Numbers(0, 6)) << cut_after;
    EXPECT_EQ(diary.acknowledged, Numbers(0, 6)) << cut_after;
    EXPECT_EQ(memory.scans.size(), 6U);
    EXPECT_EQ(diary.progress.num_resumes, memory.num_streams - 1);
  }
}

TEST(TraverseStreamTest, EveryResultOnceWhereverTheServerCutsItsAnswers) {
  for (int cut_after = 1; cut_after <= 12; ++cut_after) {
    TraverseMemory memory;
    memory.on_start = [&memory, cut_after](int num_streams) {
      memory.cut_after_sent = num_streams % 3 == 2 ? 0 : cut_after;  // counts from the next stream on
      return grpc::Status::OK;
    };
    memory.cut_after_sent = cut_after;
    const FakeTraverseServer server(memory);
    Diary diary;
    const absl::Status status = StreamAll(*ConnectTo(server.target()), diary.Options(), 0, 6);
    ASSERT_TRUE(status.ok()) << cut_after << ": " << status;
    EXPECT_EQ(diary.results, Numbers(0, 6)) << cut_after;
    EXPECT_EQ(diary.acknowledged, Numbers(0, 6)) << cut_after;
    EXPECT_EQ(memory.scans.size(), 6U);
  }
}

TEST(TraverseStreamTest, GoesOnOverCutLinks) {
  TraverseMemory memory;
  const FakeTraverseServer server(memory);
  const auto proxy = ImpairmentProxy::Start(
      server.port(), {.one_way_delay = milliseconds(10), .bytes_per_second = 60e3, .cut_every = milliseconds(400)});
  ASSERT_TRUE(proxy.ok());
  Diary diary;
  const absl::Status status = StreamAll(*ConnectTo((*proxy)->target()), diary.Options(), 0, 12);
  ASSERT_TRUE(status.ok()) << status;
  EXPECT_EQ(diary.results, Numbers(0, 12));
  EXPECT_GE(diary.progress.num_resumes, 1);
  EXPECT_EQ(diary.progress.bytes_sent - diary.progress.bytes_resent, diary.progress.bytes_acknowledged);
}

TEST(TraverseStreamTest, OutlivesARestartOfTheServer) {
  TraverseMemory memory;
  auto server = std::make_unique<FakeTraverseServer>(memory);
  const int port = server->port();
  Diary diary;
  const auto client = ConnectTo(server->target());
  auto streamer = client->traverses().Stream(kName, diary.Options());
  ASSERT_TRUE(streamer.ok());
  for (uint64_t i = 0; i < 3; ++i) ASSERT_TRUE((*streamer)->Send(ScanNumber(i)).ok());
  server.reset();
  for (uint64_t i = 3; i < 6; ++i) ASSERT_TRUE((*streamer)->Send(ScanNumber(i)).ok());
  std::this_thread::sleep_for(milliseconds(300));
  server = std::make_unique<FakeTraverseServer>(memory, port);
  const absl::Status finished = (*streamer)->Finish();
  EXPECT_TRUE(finished.ok()) << finished;
  EXPECT_EQ(diary.results, Numbers(0, 6));
  EXPECT_EQ(memory.scans.size(), 6U);
}

TEST(TraverseStreamTest, PassesOverWhatTheServerHasAndGetsOnlyNewResults) {
  TraverseMemory memory;
  const FakeTraverseServer server(memory);
  Diary first;
  ASSERT_TRUE(StreamAll(*ConnectTo(server.target()), first.Options(), 0, 4).ok());
  const uint64_t bytes_before = memory.bytes_received;
  Diary second;
  StreamOptions options = second.Options();
  options.last_result = 2;
  ASSERT_TRUE(StreamAll(*ConnectTo(server.target()), options, 2, 6).ok());
  EXPECT_EQ(second.results, Numbers(3, 6));
  EXPECT_EQ(second.acknowledged, Numbers(2, 6));
  EXPECT_EQ(second.progress.bytes_sent, memory.bytes_received - bytes_before);
  EXPECT_EQ(memory.scans.size(), 6U);
  Diary third;  // nothing to send, all results wanted
  ASSERT_TRUE(StreamAll(*ConnectTo(server.target()), third.Options(), 0, 0).ok());
  EXPECT_EQ(third.results, Numbers(0, 6));
}

TEST(TraverseStreamTest, SaysWhichScanTheServerWants) {
  TraverseMemory memory;
  const FakeTraverseServer server(memory);
  const absl::Status status = StreamAll(*ConnectTo(server.target()), Diary().Options(), 5, 6);
  EXPECT_TRUE(absl::IsOutOfRange(status)) << status;
  EXPECT_EQ(ErrorReasonName(status), "SEQUENCE_OUT_OF_RANGE");
  EXPECT_THAT(std::string(status.message()), ::testing::HasSubstr("scan 0"));
}

TEST(TraverseStreamTest, DoesNotFightANewerWriter) {
  TraverseMemory memory;
  memory.on_start = [](int) { return Refusal(v1::ERROR_REASON_WRITER_REPLACED); };
  const FakeTraverseServer server(memory);
  const absl::Status status = StreamAll(*ConnectTo(server.target()), Diary().Options(), 0, 1);
  EXPECT_TRUE(absl::IsAborted(status)) << status;
  EXPECT_EQ(memory.num_streams, 1);
}

TEST(TraverseStreamTest, WaitsForAServerThatIsNotServing) {
  TraverseMemory memory;
  memory.on_start = [](int num_streams) {  // more often than attempts of a call
    return num_streams < 9 ? Refusal(v1::ERROR_REASON_NOT_SERVING) : grpc::Status::OK;
  };
  const FakeTraverseServer server(memory);
  Diary diary;
  const absl::Status status = StreamAll(*ConnectTo(server.target()), diary.Options(), 0, 2);
  EXPECT_TRUE(status.ok()) << status;
  EXPECT_EQ(diary.results, Numbers(0, 2));
}

TEST(TraverseStreamTest, GivesUpInTheEnd) {
  TraverseMemory memory;
  memory.on_start = [](int) { return grpc::Status(grpc::UNAVAILABLE, "never"); };
  const FakeTraverseServer server(memory);
  ClientOptions options = QuickOptions();
  options.call_timeout = milliseconds(500);
  const Clock::time_point start = Clock::now();
  const absl::Status status = StreamAll(*ConnectTo(server.target(), options), Diary().Options(), 0, 1);
  EXPECT_TRUE(absl::IsUnavailable(status)) << status;
  EXPECT_LT(Clock::now() - start, milliseconds(5000));
}

TEST(TraverseStreamTest, GivesUpWhenStreamsBeginAndBringNothing) {
  TraverseMemory memory;
  memory.cut_after_received = 1;
  const FakeTraverseServer server(memory);
  ClientOptions options = QuickOptions();
  options.call_timeout = milliseconds(500);
  const Clock::time_point start = Clock::now();
  const absl::Status status = StreamAll(*ConnectTo(server.target(), options), Diary().Options(), 0, 1);
  EXPECT_TRUE(absl::IsUnavailable(status)) << status;
  EXPECT_LT(Clock::now() - start, milliseconds(5000));
}

TEST(TraverseStreamTest, KeepsNoMoreThanAllowed) {
  TraverseMemory memory;
  memory.on_start = [](int) { return grpc::Status(grpc::UNAVAILABLE, "not yet"); };
  const FakeTraverseServer server(memory);
  StreamOptions options = Diary().Options();
  options.on_result = nullptr;
  options.on_acknowledged = nullptr;
  options.on_progress = nullptr;
  options.max_waiting_bytes = 10'000;
  const auto client = ConnectTo(server.target());
  auto streamer = client->traverses().Stream(kName, options);
  ASSERT_TRUE(streamer.ok());
  std::atomic<int> num_sent = 0;
  std::jthread sender([&] {
    for (uint64_t i = 0; i < 20 && (*streamer)->Send(ScanNumber(i)).ok(); ++i) ++num_sent;
  });
  std::this_thread::sleep_for(milliseconds(300));
  EXPECT_GE(num_sent, 1);
  EXPECT_LE(num_sent, 3);
  {
    const std::lock_guard lock(memory.mutex);
    memory.on_start = nullptr;
  }
  sender.join();
  EXPECT_EQ(num_sent, 20);
  EXPECT_TRUE((*streamer)->Finish().ok());
}

TEST(TraverseStreamTest, IsCancelledAndDestroyedAtAnyTime) {
  TraverseMemory memory;
  const FakeTraverseServer server(memory);
  const auto client = ConnectTo(server.target());
  std::stop_source source;
  StreamOptions options;
  options.cancellation = source.get_token();
  auto streamer = client->traverses().Stream(kName, options);
  ASSERT_TRUE(streamer.ok());
  ASSERT_TRUE((*streamer)->Send(ScanNumber(0)).ok());
  source.request_stop();
  EXPECT_TRUE(absl::IsCancelled((*streamer)->Finish()));
  for (int i = 0; i < 20; ++i) {
    auto dropped = client->traverses().Stream(kName, {});
    ASSERT_TRUE(dropped.ok());
    ASSERT_TRUE((*dropped)->Send(ScanNumber(memory.scans.size())).ok());
    std::this_thread::sleep_for(milliseconds(i));
  }
}

}  // namespace
}  // namespace curvereg
