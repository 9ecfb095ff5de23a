// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/traverses/scan_stream_session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "tests/server/traverses/fake_traverses.h"
#include "tests/server/traverses/stream_server.h"
#include "tests/testing/matchers.h"
#include "wire/digest.h"

namespace curvereg::testing {
namespace {

using ::testing::ElementsAre;

constexpr uint64_t kPayloadBytes = 12'000;

v1::PointCloud Cloud(uint64_t seed) { return RandomCloud(1000, seed); }

class ScanStreamTest : public ::testing::Test {
 protected:
  // Sends it and waits until it is acknowledged, on a stream of its own.
  void SendComplete(uint64_t sequence_number) {
    StreamClient client(*stub_);
    client.Begin();
    client.SendScan(sequence_number, Cloud(sequence_number));
    ASSERT_TRUE(client.ReceiveComplete(sequence_number));
  }

  // The end of a stream that sends these after `start`.
  absl::Status EndOf(const std::vector<v1::StreamScansRequest>& requests) {
    StreamClient client(*stub_);
    client.Begin();
    for (const v1::StreamScansRequest& request : requests) {
      if (!client.Send(request)) break;
    }
    return client.End();
  }

  FakeTraverses traverses_;
  StreamServer server_{traverses_};
  std::unique_ptr<v1::TraverseService::Stub> stub_ = server_.NewStub();
};

TEST_F(ScanStreamTest, TakesScansInARowAndTellsTheirResults) {
  StreamClient client(*stub_);
  const v1::StreamScansReady ready = client.Begin();
  EXPECT_EQ(ready.next_sequence_number(), 0);
  EXPECT_EQ(ready.committed_offset(), 0);
  EXPECT_EQ(ready.fencing_number(), 1);
  EXPECT_EQ(ready.max_chunk_bytes(), 1U << 20);
  for (uint64_t i = 0; i < 5; ++i) ASSERT_TRUE(client.SendScan(i, Cloud(i)));
  client.HalfClose();
  EXPECT_THAT(client.End(), IsOk());
  EXPECT_THAT(client.ResultNumbers(), ElementsAre(0, 1, 2, 3, 4));
  ASSERT_EQ(client.acks().size(), 5);
  for (const auto& [number, ack] : client.acks()) {
    EXPECT_TRUE(ack.complete());
    EXPECT_EQ(ack.committed_offset(), kPayloadBytes);
    EXPECT_EQ(ack.scan(), "scans/" + traverses_.ScanIdOf(number));
    const absl::StatusOr<std::string> payload = server_.scans().store().ReadWholePayload(traverses_.ScanIdOf(number));
    ASSERT_THAT(payload, IsOk());
    EXPECT_EQ(*payload, Cloud(number).data());
  }
  EXPECT_EQ(server_.scans().store().Statistics().num_uploads, 0);
  EXPECT_EQ(server_.scans().memory().reserved_bytes(), 0);
}

TEST_F(ScanStreamTest, GoesOnWhereAScanWasCut) {
  SendComplete(0);
  {
    StreamClient cut(*stub_);
    cut.Begin();
    cut.Send(StreamHeader(1, Cloud(1)));
    cut.Send(StreamChunk(Cloud(1), 0, 5000));
    ASSERT_TRUE(cut.ReceiveOffset(1, 5000));
  }
  StreamClient client(*stub_);
  const v1::StreamScansReady ready = client.Begin(0);
  EXPECT_EQ(ready.next_sequence_number(), 1);
  EXPECT_EQ(ready.committed_offset(), 5000);
  client.Send(StreamHeader(1, Cloud(1)));
  ASSERT_TRUE(client.ReceiveOffset(1, 5000)) << "also told in answer to the header";
  client.Send(StreamChunk(Cloud(1), 5000, 7000));
  ASSERT_TRUE(client.ReceiveComplete(1));
  ASSERT_TRUE(client.ReceiveResult(1));
  EXPECT_EQ(*server_.scans().store().ReadWholePayload(traverses_.ScanIdOf(1)), Cloud(1).data());
  EXPECT_THAT(client.ResultNumbers(), ElementsAre(1)) << "the client said that it has the other";
}

TEST_F(ScanStreamTest, LeavesOutBytesThatItHas) {
  {
    StreamClient cut(*stub_);
    cut.Begin();
    cut.Send(StreamHeader(0, Cloud(0)));
    cut.Send(StreamChunk(Cloud(0), 0, 5000));
    ASSERT_TRUE(cut.ReceiveOffset(0, 5000));
  }
  // All from the beginning; of the second chunk the first 1000 bytes are there.
  StreamClient client(*stub_);
  EXPECT_EQ(client.Begin().committed_offset(), 5000);
  client.SendScan(0, Cloud(0), 4000);
  ASSERT_TRUE(client.ReceiveComplete(0));
  EXPECT_EQ(*server_.scans().store().ReadWholePayload(traverses_.ScanIdOf(0)), Cloud(0).data());
}

TEST_F(ScanStreamTest, BeginsAgainWhenAnUnfinishedScanIsAnotherOne) {
  {
    StreamClient cut(*stub_);
    cut.Begin();
    cut.Send(StreamHeader(0, Cloud(0)));
    cut.Send(StreamChunk(Cloud(0), 0, 5000));
    ASSERT_TRUE(cut.ReceiveOffset(0, 5000));
  }
  StreamClient client(*stub_);
  client.Begin();
  client.Send(StreamHeader(0, Cloud(7)));
  const auto ack = client.Receive();
  ASSERT_TRUE(ack.has_value() && ack->has_ack());
  EXPECT_EQ(ack->ack().committed_offset(), 0);
  client.Send(StreamChunk(Cloud(7), 0, kPayloadBytes));
  ASSERT_TRUE(client.ReceiveComplete(0));
  EXPECT_EQ(*server_.scans().store().ReadWholePayload(traverses_.ScanIdOf(0)), Cloud(7).data());
}

TEST_F(ScanStreamTest, RecognisesAScanThatComesAgain) {
  SendComplete(0);
  StreamClient client(*stub_);
  EXPECT_EQ(client.Begin().next_sequence_number(), 1);
  client.SendScan(0, Cloud(0));  // chunks and all
  ASSERT_TRUE(client.ReceiveComplete(0));
  EXPECT_EQ(client.acks().at(0).scan(), "scans/" + traverses_.ScanIdOf(0));
  client.SendScan(1, Cloud(1));
  ASSERT_TRUE(client.ReceiveComplete(1));
  EXPECT_EQ(traverses_.num_added(), 2);
}

TEST_F(ScanStreamTest, RecognisesAScanByAnotherDigest) {
  v1::StreamScansRequest header = StreamHeader(0, Cloud(0));
  *header.mutable_header()->mutable_payload_digest() = Sha256(Cloud(0).data());
  for (int i = 0; i < 2; ++i) {
    StreamClient client(*stub_);
    client.Begin();
    client.Send(header);
    client.Send(StreamChunk(Cloud(0), 0, kPayloadBytes));
    ASSERT_TRUE(client.ReceiveComplete(0));
    EXPECT_EQ(client.acks().at(0).scan(), "scans/" + traverses_.ScanIdOf(0));
  }
  EXPECT_EQ(traverses_.num_added(), 1);
  EXPECT_EQ(server_.scans().store().Statistics().num_scans, 1);
}

TEST_F(ScanStreamTest, NeedsNoBytesOfAScanThatIsStored) {
  ASSERT_THAT(Upload(*server_.scans().NewStub(), "a", Cloud(0)), IsOk());
  StreamClient client(*stub_);
  client.Begin();
  client.Send(StreamHeader(0, Cloud(0)));
  ASSERT_TRUE(client.ReceiveComplete(0));
  ASSERT_TRUE(client.ReceiveResult(0));
  EXPECT_EQ(traverses_.num_added(), 1);
}

TEST_F(ScanStreamTest, RefusesGapsAndOtherPayloads) {
  SendComplete(0);
  const absl::Status gap = EndOf({StreamHeader(2, Cloud(2))});
  EXPECT_THAT(gap, HasCode(absl::StatusCode::kOutOfRange));
  EXPECT_EQ(ReasonText(gap), "SEQUENCE_OUT_OF_RANGE");
  EXPECT_EQ(MetadataOf(gap, "next_sequence_number"), "1");
  const absl::Status differs = EndOf({StreamHeader(0, Cloud(2))});
  EXPECT_THAT(differs, HasCode(absl::StatusCode::kFailedPrecondition));
  EXPECT_EQ(ReasonText(differs), "SEQUENCE_DIFFERS");
}

TEST_F(ScanStreamTest, TellsWhatIsAcknowledgedBeforeItsError) {
  StreamClient client(*stub_);
  client.Begin();
  client.SendScan(0, Cloud(0));
  client.Send(StreamHeader(5, Cloud(5)));
  EXPECT_EQ(ReasonText(client.End()), "SEQUENCE_OUT_OF_RANGE");
  ASSERT_EQ(client.acks().count(0), 1);
  EXPECT_TRUE(client.acks().at(0).complete());
}

TEST_F(ScanStreamTest, IsFencedOffByASecondStream) {
  StreamClient first(*stub_);
  EXPECT_EQ(first.Begin().fencing_number(), 1);
  first.Send(StreamHeader(0, Cloud(0)));
  first.Send(StreamChunk(Cloud(0), 0, 5000));
  ASSERT_TRUE(first.ReceiveOffset(0, 5000));
  // The first one is idle, and told all the same.
  StreamClient second(*stub_);
  EXPECT_EQ(second.Begin().fencing_number(), 2);
  const absl::Status replaced = first.End();
  EXPECT_THAT(replaced, HasCode(absl::StatusCode::kAborted));
  EXPECT_EQ(ReasonText(replaced), "WRITER_REPLACED");
  second.SendScan(0, Cloud(0));
  EXPECT_TRUE(second.ReceiveComplete(0));
}

TEST_F(ScanStreamTest, RefusesDamagedChunksAndKeepsTheRest) {
  v1::StreamScansRequest damaged = StreamChunk(Cloud(0), 4000, 4000);
  damaged.mutable_chunk()->set_crc32c(damaged.chunk().crc32c() + 1);
  const absl::Status status = EndOf({StreamHeader(0, Cloud(0)), StreamChunk(Cloud(0), 0, 4000), damaged});
  EXPECT_THAT(status, HasCode(absl::StatusCode::kDataLoss));
  EXPECT_EQ(ReasonText(status), "CHECKSUM_MISMATCH");
  StreamClient client(*stub_);
  EXPECT_EQ(client.Begin().committed_offset(), 4000);
}

TEST_F(ScanStreamTest, ForgetsAPayloadOfAnotherDigest) {
  v1::StreamScansRequest header = StreamHeader(0, Cloud(0));
  *header.mutable_header()->mutable_payload_digest() = Xxh3("other");
  EXPECT_EQ(ReasonText(EndOf({header, StreamChunk(Cloud(0), 0, kPayloadBytes)})), "DIGEST_MISMATCH");
  EXPECT_EQ(traverses_.num_added(), 0);
  EXPECT_EQ(server_.scans().store().Statistics().stored_bytes, 0);
  SendComplete(0);
}

TEST_F(ScanStreamTest, RefusesChunksOutOfPlace) {
  const v1::PointCloud cloud = Cloud(0);
  const absl::Status gap = EndOf({StreamHeader(0, cloud), StreamChunk(cloud, 4000, 4000)});
  EXPECT_EQ(ReasonText(gap), "OFFSET_OUT_OF_RANGE");
  EXPECT_EQ(MetadataOf(gap, "committed_offset"), "0");
  v1::StreamScansRequest beyond = StreamChunk(cloud, 8000, 4000);
  beyond.mutable_chunk()->mutable_data()->append("x");
  beyond.mutable_chunk()->set_crc32c(wire::Crc32c(beyond.chunk().data()));
  EXPECT_EQ(ReasonText(EndOf({StreamHeader(0, cloud), StreamChunk(cloud, 0, 8000), beyond})), "OFFSET_OUT_OF_RANGE");
  v1::StreamScansRequest empty = StreamChunk(cloud, 0, 4000);
  empty.mutable_chunk()->clear_data();
  EXPECT_EQ(ReasonText(EndOf({StreamHeader(0, cloud), empty})), "INVALID_FIELD");
  v1::StreamScansRequest unchecked = StreamChunk(cloud, 0, 4000);
  unchecked.mutable_chunk()->clear_crc32c();
  EXPECT_EQ(ReasonText(EndOf({StreamHeader(0, cloud), unchecked})), "INVALID_FIELD");
}

TEST_F(ScanStreamTest, RefusesHeadersThatCannotBe) {
  const std::vector<std::pair<std::function<void(v1::StreamedScanHeader&)>, std::string>> cases = {
      {[](v1::StreamedScanHeader& h) { h.clear_header(); }, "header.header"},
      {[](v1::StreamedScanHeader& h) { h.set_payload_bytes(0); }, "header.payload_bytes"},
      {[](v1::StreamedScanHeader& h) { h.clear_payload_digest(); }, "header.payload_digest"},
      {[](v1::StreamedScanHeader& h) { h.mutable_payload_digest()->set_value("short"); },
       "header.payload_digest.value"},
      {[](v1::StreamedScanHeader& h) { h.mutable_header()->clear_layout(); }, "header.header.layout"},
      {[](v1::StreamedScanHeader& h) { h.mutable_prior(); }, "header.prior.t_target_source"},
  };
  for (const auto& [change, field] : cases) {
    v1::StreamScansRequest request = StreamHeader(0, Cloud(0));
    change(*request.mutable_header());
    const absl::Status status = EndOf({request});
    ASSERT_EQ(ReasonText(status), "INVALID_FIELD") << field;
    EXPECT_THAT(wire::BadRequestOf(status)->field_violations(0).field(), ::testing::StartsWith(field));
  }
}

TEST_F(ScanStreamTest, RefusesMessagesOutOfOrder) {
  const v1::PointCloud cloud = Cloud(0);
  EXPECT_EQ(ReasonText(EndOf({StreamStart()})), "UNEXPECTED_MESSAGE");
  EXPECT_EQ(ReasonText(EndOf({StreamChunk(cloud, 0, 4000)})), "UNEXPECTED_MESSAGE");
  EXPECT_EQ(ReasonText(EndOf({v1::StreamScansRequest()})), "UNEXPECTED_MESSAGE");
  EXPECT_EQ(ReasonText(EndOf({StreamHeader(0, cloud), StreamHeader(0, cloud)})), "UNEXPECTED_MESSAGE");
  StreamClient headless(*stub_);
  headless.Send(StreamHeader(0, cloud));
  EXPECT_EQ(ReasonText(headless.End()), "UNEXPECTED_MESSAGE");
  StreamClient silent(*stub_);
  silent.HalfClose();
  EXPECT_EQ(ReasonText(silent.End()), "UNEXPECTED_MESSAGE");
  StreamClient cut(*stub_);
  cut.Begin();
  cut.Send(StreamHeader(0, cloud));
  cut.HalfClose();
  EXPECT_EQ(ReasonText(cut.End()), "UNEXPECTED_MESSAGE");
}

TEST_F(ScanStreamTest, RefusesResultsThatCannotBe) {
  StreamClient client(*stub_);
  client.Send(StreamStart(0));
  EXPECT_EQ(ReasonText(client.End()), "INVALID_FIELD");
}

TEST_F(ScanStreamTest, RefusesTraversesThatAreNot) {
  v1::StreamScansRequest start;
  start.mutable_start()->set_traverse("traverses/other");
  StreamClient other(*stub_);
  other.Send(start);
  EXPECT_EQ(ReasonText(other.End()), "TRAVERSE_NOT_FOUND");
  start.mutable_start()->set_traverse("scans/t");
  StreamClient misnamed(*stub_);
  misnamed.Send(start);
  const absl::Status status = misnamed.End();
  ASSERT_EQ(ReasonText(status), "INVALID_FIELD");
  EXPECT_EQ(wire::BadRequestOf(status)->field_violations(0).field(), "start.traverse");
}

TEST_F(ScanStreamTest, EndsWhenTheTraverseIsDeleted) {
  StreamClient client(*stub_);
  client.Begin();
  ASSERT_THAT(traverses_.Delete(FakeTraverses::kName), IsOk());
  EXPECT_EQ(ReasonText(client.End()), "TRAVERSE_NOT_FOUND");
}

TEST_F(ScanStreamTest, LetsGoOfIdleStreamsWhenTheServerDrains) {
  StreamClient silent(*stub_);
  StreamClient idle(*stub_);
  idle.Begin();
  ASSERT_TRUE(WaitUntil([&] { return server_.OpenCalls("StreamScans") == 2; }));
  server_.Drain();
  EXPECT_EQ(ReasonText(silent.End()), "NOT_SERVING");
  EXPECT_EQ(ReasonText(idle.End()), "NOT_SERVING");
}

TEST_F(ScanStreamTest, EndsAtTheDeadlineOfTheCaller) {
  StreamClient client(*stub_, std::chrono::milliseconds(100));
  client.Send(StreamStart());
  EXPECT_THAT(client.End(), HasCode(absl::StatusCode::kDeadlineExceeded));
  EXPECT_TRUE(WaitUntil([&] { return server_.OpenCalls("StreamScans") == 0; }));
}

TEST_F(ScanStreamTest, OutlivesClientsThatDisappearInAnyState) {
  const v1::PointCloud cloud = RandomCloud(20'000, 1);
  const std::vector<std::function<void(StreamClient&)>> lives = {
      [](StreamClient&) {},
      [](StreamClient& c) { c.Send(StreamStart()); },
      [](StreamClient& c) { c.Begin(); },
      [&](StreamClient& c) {
        c.Begin();
        c.Send(StreamHeader(0, cloud));
        for (uint64_t i = 0; i < 4; ++i) c.Send(StreamChunk(cloud, i * 50'000, 50'000));
      },
      [](StreamClient& c) {
        c.Begin();
        c.HalfClose();
      },
  };
  for (int round = 0; round < 5; ++round) {
    for (const auto& live : lives) {
      StreamClient client(*stub_);
      live(client);
    }
  }
  EXPECT_TRUE(WaitUntil([&] { return server_.OpenCalls("StreamScans") == 0; }));
  EXPECT_EQ(server_.scans().memory().reserved_bytes(), 0);
  StreamClient client(*stub_);
  client.Begin();
  client.SendScan(0, cloud, 50'000);
  EXPECT_TRUE(client.ReceiveComplete(0));
}

// Results come when the test says so.
class LateResultsTest : public ::testing::Test {
 protected:
  LateResultsTest() {
    StreamClient client(*stub_);
    client.Begin();
    for (uint64_t i = 0; i < 3; ++i) client.SendScan(i, Cloud(i));
    EXPECT_TRUE(client.ReceiveComplete(2));
  }

  FakeTraverses traverses_{false};
  StreamServer server_{traverses_};
  std::unique_ptr<v1::TraverseService::Stub> stub_ = server_.NewStub();
};

TEST_F(LateResultsTest, TellsResultsAsTheyCome) {
  StreamClient client(*stub_);
  client.Begin();
  for (uint64_t i = 0; i < 3; ++i) {
    traverses_.Register(i);
    ASSERT_TRUE(client.ReceiveResult(i));
  }
  EXPECT_THAT(client.ResultNumbers(), ElementsAre(0, 1, 2));
}

TEST_F(LateResultsTest, TellsAgainAfterACutWhatTheClientHasNot) {
  for (uint64_t i = 0; i < 3; ++i) traverses_.Register(i);
  StreamClient first(*stub_);
  first.Begin();
  ASSERT_TRUE(first.ReceiveResult(2));
  StreamClient again(*stub_);
  again.Begin();
  ASSERT_TRUE(again.ReceiveResult(2));
  EXPECT_THAT(again.ResultNumbers(), ElementsAre(0, 1, 2));
  StreamClient later(*stub_);
  later.Begin(1);
  ASSERT_TRUE(later.ReceiveResult(2));
  EXPECT_THAT(later.ResultNumbers(), ElementsAre(2));
}

TEST_F(LateResultsTest, WaitsForAllResultsAfterTheLastScan) {
  traverses_.Register(0);
  StreamClient client(*stub_);
  client.Begin();
  client.HalfClose();
  ASSERT_TRUE(client.ReceiveResult(0));
  traverses_.Register(1);
  ASSERT_TRUE(client.ReceiveResult(1));
  EXPECT_EQ(server_.OpenCalls("StreamScans"), 1);
  traverses_.Register(2);
  EXPECT_THAT(client.End(), IsOk());
  EXPECT_THAT(client.ResultNumbers(), ElementsAre(0, 1, 2));
}

TEST_F(LateResultsTest, TellsMoreResultsThanAreReadAtOnce) {
  StreamClient sender(*stub_);
  sender.Begin();
  for (uint64_t i = 3; i < 30; ++i) sender.SendScan(i, Cloud(i));
  ASSERT_TRUE(sender.ReceiveComplete(29));
  for (uint64_t i = 0; i < 30; ++i) traverses_.Register(i);
  sender.HalfClose();
  EXPECT_THAT(sender.End(), IsOk());
  EXPECT_EQ(sender.results().size(), 30);
  for (uint64_t i = 0; i < 30; ++i) EXPECT_EQ(sender.ResultNumbers()[i], i);
}

TEST(ScanStreamLimits, RefusesScansAndChunksThatAreTooLarge) {
  FakeTraverses traverses;
  StreamServerOptions options;
  options.scans.limits.max_scan_points = 1000;
  options.scans.limits.max_chunk_bytes = 4000;
  StreamServer server(traverses, options);
  const auto stub = server.NewStub();
  StreamClient large(*stub);
  EXPECT_EQ(large.Begin().max_chunk_bytes(), 4000);
  large.Send(StreamHeader(0, RandomCloud(1001, 1)));
  EXPECT_EQ(ReasonText(large.End()), "SCAN_TOO_LARGE");
  StreamClient client(*stub);
  client.Begin();
  client.SendScan(0, Cloud(0), 4001);
  EXPECT_EQ(ReasonText(client.End()), "INVALID_FIELD");
}

TEST(ScanStreamLimits, RefusesScansThatNeverFitIntoMemory) {
  FakeTraverses traverses;
  StreamServerOptions options;
  options.scans.memory_bytes = 1000;
  StreamServer server(traverses, options);
  const auto stub = server.NewStub();
  StreamClient client(*stub);
  client.Begin();
  client.Send(StreamHeader(0, Cloud(0)));
  EXPECT_EQ(ReasonText(client.End()), "SCAN_TOO_LARGE");
}

}  // namespace
}  // namespace curvereg::testing
