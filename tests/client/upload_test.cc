// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Uploads to servers that misbehave, and servers that say no.
#include <atomic>
#include <chrono>
#include <limits>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/client.h"
#include "tests/client/scripted_server.h"
#include "wire/digest.h"

namespace curvereg {
namespace {

using std::chrono::milliseconds;
using testing::ConnectTo;
using testing::QuickOptions;
using testing::Refusal;
using testing::Script;
using testing::ScriptedServer;
using testing::StrewnScan;
using Clock = std::chrono::steady_clock;

TransferOptions Raw() {
  TransferOptions options;
  options.encoding.kind = TransferEncoding::Kind::kRaw;
  return options;
}

// A server's part of one upload, kept in memory, that ends each stream after `cut_after` chunks.
struct UploadMemory {
  std::string upload;
  std::string bytes;
  std::vector<uint64_t> chunk_sizes;
  int num_streams = 0;
  int cut_after = 1'000'000;
};

grpc::Status Keep(UploadMemory& memory, Script::UploadStream& stream) {
  ++memory.num_streams;
  v1::UploadScanRequest request;
  v1::UploadScanResponse response;
  stream.Read(&request);
  EXPECT_TRUE(memory.upload.empty() || memory.upload == request.start().upload()) << "resumed under another name";
  memory.upload = request.start().upload();
  const v1::UploadScanStart start = request.start();
  response.mutable_ready()->set_committed_offset(memory.bytes.size());
  response.mutable_ready()->set_max_chunk_bytes(1 << 20);
  stream.Write(response);
  for (int count = 0; stream.Read(&request) && request.has_chunk();) {
    EXPECT_EQ(request.chunk().offset(), memory.bytes.size());
    EXPECT_EQ(request.chunk().crc32c(), wire::Crc32c(request.chunk().data()));
    memory.bytes += request.chunk().data();
    memory.chunk_sizes.push_back(request.chunk().data().size());
    response.mutable_progress()->set_committed_offset(memory.bytes.size());
    stream.Write(response);
    if (++count == memory.cut_after) return {grpc::UNAVAILABLE, "cut"};
  }
  EXPECT_TRUE(request.has_finish());
  EXPECT_TRUE(wire::SameDigest(start.payload_digest(), wire::DigestOf(v1::DIGEST_ALGORITHM_XXH3_128, memory.bytes)));
  response.mutable_done()->mutable_scan()->set_name("scans/made");
  response.mutable_done()->mutable_scan()->set_payload_bytes(memory.bytes.size());
  stream.Write(response);
  return grpc::Status::OK;
}

Script WithUpload(decltype(Script::upload_scan) function) {
  Script script;
  script.upload_scan = std::move(function);
  return script;
}

TEST(UploadTest, BringsEveryByteOverAndTellsProgress) {
  UploadMemory memory;
  const ScriptedServer server(WithUpload([&](auto&, auto& stream) { return Keep(memory, stream); }));
  const Scan scan = StrewnScan(300'000);
  TransferOptions options = Raw();
  std::vector<TransferProgress> told;
  options.progress = [&](const TransferProgress& progress) { told.push_back(progress); };
  const auto outcome = ConnectTo(server.target())->UploadScan(scan, options);
  ASSERT_TRUE(outcome.ok()) << outcome.status();
  EXPECT_EQ(outcome->scan.name, "scans/made");
  EXPECT_FALSE(outcome->already_stored);
  EXPECT_EQ(memory.bytes, std::string(reinterpret_cast<const char*>(scan.points.data()), 12 * scan.points.size()));
  EXPECT_EQ(outcome->transfer.bytes_total, memory.bytes.size());
  EXPECT_EQ(outcome->transfer.bytes_done, memory.bytes.size());
  EXPECT_EQ(outcome->transfer.bytes_resent, 0U);
  EXPECT_EQ(outcome->transfer.num_resumes, 0);
  EXPECT_EQ(memory.upload.size(), std::string("uploads/").size() + 32);
  ASSERT_FALSE(told.empty());
  for (size_t i = 1; i < told.size(); ++i) EXPECT_GT(told[i].bytes_done, told[i - 1].bytes_done);
  EXPECT_EQ(told.back().bytes_done, memory.bytes.size());
}

TEST(UploadTest, GoesOnUnderTheSameNameAfterCuts) {
  UploadMemory memory;
  memory.cut_after = 3;
  const ScriptedServer server(WithUpload([&](auto&, auto& stream) { return Keep(memory, stream); }));
  const Scan scan = StrewnScan();
  ClientOptions options = QuickOptions();
  options.retry.max_attempts = 2;  // fewer than there are cuts: each stream makes progress
  const auto outcome = ConnectTo(server.target(), options)->UploadScan(scan, Raw());
  ASSERT_TRUE(outcome.ok()) << outcome.status();
  EXPECT_EQ(memory.bytes.size(), 12 * scan.points.size());
  EXPECT_GE(memory.num_streams, 4);
  EXPECT_EQ(outcome->transfer.num_resumes, memory.num_streams - 1);
}

TEST(UploadTest, StartsAgainWhereTheServerLostEverything) {
  UploadMemory memory;
  memory.cut_after = 4;
  const ScriptedServer server(WithUpload([&](auto&, auto& stream) {
    if (memory.num_streams == 1) {
      memory.bytes.clear();
      memory.cut_after = 1'000'000;
    }
    return Keep(memory, stream);
  }));
  const Scan scan = StrewnScan();
  const auto outcome = ConnectTo(server.target())->UploadScan(scan, Raw());
  ASSERT_TRUE(outcome.ok()) << outcome.status();
  EXPECT_EQ(memory.bytes.size(), 12 * scan.points.size());
  EXPECT_GE(outcome->transfer.bytes_resent, uint64_t{4 * 16 * 1024});
}

TEST(UploadTest, SendsNothingWhereTheScanIsKnown) {
  const ScriptedServer server(WithUpload([&](auto&, auto& stream) {
    v1::UploadScanRequest request;
    stream.Read(&request);
    EXPECT_EQ(request.start().payload_digest().algorithm(), v1::DIGEST_ALGORITHM_XXH3_128);
    EXPECT_EQ(request.start().header().frame_id(), "mast");
    v1::UploadScanResponse response;
    response.mutable_done()->set_already_stored(true);
    response.mutable_done()->mutable_scan()->set_name("scans/known");
    stream.Write(response);
    return grpc::Status::OK;
  }));
  TransferOptions options = Raw();
  options.frame_id = "mast";
  const auto outcome = ConnectTo(server.target())->UploadScan(StrewnScan(), options);
  ASSERT_TRUE(outcome.ok()) << outcome.status();
  EXPECT_TRUE(outcome->already_stored);
  EXPECT_EQ(outcome->scan.name, "scans/known");
}

// The name that a call starts with, at a server that does not let it get further.
std::string NameOfUpload(const Scan& scan, const TransferOptions& options) {
  std::string name;
  const ScriptedServer server(WithUpload([&](auto&, auto& stream) {
    v1::UploadScanRequest request;
    stream.Read(&request);
    name = request.start().upload();
    return Refusal(v1::ERROR_REASON_STORAGE_FULL);
  }));
  EXPECT_FALSE(ConnectTo(server.target())->UploadScan(scan, options).ok());
  return name;
}

TEST(UploadTest, TheNameTellsTheScan) {
  const std::string name = NameOfUpload(StrewnScan(), Raw());
  EXPECT_EQ(NameOfUpload(StrewnScan(), Raw()), name);
  Scan scan = StrewnScan();
  scan.points.back().x() += 1.0F;
  EXPECT_NE(NameOfUpload(scan, Raw()), name);
  TransferOptions options = Raw();
  options.frame_id = "mast";
  EXPECT_NE(NameOfUpload(StrewnScan(), options), name);
}

TEST(UploadTest, GoesOnFromWhereADeadClientStopped) {
  UploadMemory memory;
  const ScriptedServer server(WithUpload([&](auto&, auto& stream) { return Keep(memory, stream); }));
  const Scan scan = StrewnScan(300'000);
  std::stop_source death;
  TransferOptions options = Raw();
  options.cancellation = death.get_token();
  memory.cut_after = 3;
  options.progress = [&](const TransferProgress&) { death.request_stop(); };
  EXPECT_TRUE(absl::IsCancelled(ConnectTo(server.target())->UploadScan(scan, options).status()));
  const uint64_t committed = memory.bytes.size();
  ASSERT_GT(committed, 0U);
  memory.cut_after = 1'000'000;
  const auto outcome = ConnectTo(server.target())->UploadScan(scan, Raw());  // Keep expects the name and the offset
  ASSERT_TRUE(outcome.ok()) << outcome.status();
  EXPECT_EQ(memory.bytes, std::string(reinterpret_cast<const char*>(scan.points.data()), 12 * scan.points.size()));
  EXPECT_EQ(outcome->transfer.bytes_resent, 0U);
}

TEST(UploadTest, LeavesTheNameToAnotherWriter) {
  UploadMemory memory;
  std::string first;
  const ScriptedServer server(WithUpload([&](auto&, auto& stream) {
    if (!first.empty()) return Keep(memory, stream);
    v1::UploadScanRequest request;
    stream.Read(&request);
    first = request.start().upload();
    return Refusal(v1::ERROR_REASON_WRITER_REPLACED);
  }));
  const Scan scan = StrewnScan();
  const auto outcome = ConnectTo(server.target())->UploadScan(scan, Raw());
  ASSERT_TRUE(outcome.ok()) << outcome.status();
  EXPECT_NE(memory.upload, first);
  EXPECT_EQ(memory.bytes.size(), 12 * scan.points.size());
}

TEST(UploadTest, DoesNotFightAnotherWriter) {
  std::atomic<int> num_streams = 0;
  const ScriptedServer server(WithUpload([&](auto&, auto&) {
    ++num_streams;
    return Refusal(v1::ERROR_REASON_WRITER_REPLACED);
  }));
  const auto outcome = ConnectTo(server.target())->UploadScan(StrewnScan());
  EXPECT_TRUE(absl::IsAborted(outcome.status())) << outcome.status();
  EXPECT_EQ(ErrorReasonName(outcome.status()), "WRITER_REPLACED");
  EXPECT_EQ(num_streams, 2) << "once under the scan's name, once under its own";
}

TEST(UploadTest, StartsAnewWhereWhatOthersLeftIsWrong) {
  std::vector<std::string> names;
  const auto run = [&](uint64_t left_bytes) {
    names.clear();
    const ScriptedServer server(WithUpload([&](auto&, auto& stream) {
      v1::UploadScanRequest request;
      v1::UploadScanResponse response;
      stream.Read(&request);
      names.push_back(request.start().upload());
      response.mutable_ready()->set_committed_offset(names.size() == 1 ? left_bytes : 0);
      stream.Write(response);
      while (stream.Read(&request) && request.has_chunk()) {
        response.mutable_progress()->set_committed_offset(request.chunk().offset() + request.chunk().data().size());
        stream.Write(response);
      }
      return Refusal(v1::ERROR_REASON_DIGEST_MISMATCH);
    }));
    return ErrorReasonName(ConnectTo(server.target())->UploadScan(StrewnScan(), Raw()).status());
  };
  EXPECT_EQ(run(1'200), "DIGEST_MISMATCH");
  ASSERT_EQ(names.size(), 2U);
  EXPECT_NE(names[0], names[1]);
  EXPECT_EQ(run(0), "DIGEST_MISMATCH");
  EXPECT_EQ(names.size(), 1U) << "all bytes were its own";
}

TEST(UploadTest, GivesUpWhenThereIsNoProgress) {
  std::atomic<int> num_streams = 0;
  const ScriptedServer server(WithUpload([&](auto&, auto&) {
    ++num_streams;
    return grpc::Status(grpc::UNAVAILABLE, "cut");
  }));
  ClientOptions options = QuickOptions();
  options.retry.max_attempts = 3;
  EXPECT_TRUE(absl::IsUnavailable(ConnectTo(server.target(), options)->UploadScan(StrewnScan()).status()));
  EXPECT_EQ(num_streams, 3);
}

TEST(UploadTest, EndsAnswersThatDoNotFitTogether) {
  const auto answer = [](const v1::UploadScanResponse& response) {
    const ScriptedServer server(WithUpload([&](auto& context, auto& stream) {
      v1::UploadScanRequest request;
      stream.Read(&request);
      stream.Write(response);
      while (!context.IsCancelled()) std::this_thread::sleep_for(milliseconds(2));
      return grpc::Status::CANCELLED;
    }));
    ClientOptions options = QuickOptions();
    options.retry.max_attempts = 2;
    return ConnectTo(server.target(), options)->UploadScan(StrewnScan()).status();
  };
  v1::UploadScanResponse response;
  EXPECT_TRUE(absl::IsInternal(answer(response))) << "empty";
  response.mutable_progress()->set_committed_offset(1);
  EXPECT_TRUE(absl::IsInternal(answer(response))) << "progress before ready";
  response.mutable_ready()->set_committed_offset(uint64_t{1} << 40);
  EXPECT_TRUE(absl::IsInternal(answer(response))) << "ready beyond the end";
}

TEST(UploadTest, AServerThatFallsSilentIsAskedAgain) {
  UploadMemory memory;
  std::atomic<int> num_streams = 0;
  const ScriptedServer server(WithUpload([&](auto& context, auto& stream) {
    if (++num_streams > 1) return Keep(memory, stream);
    while (!context.IsCancelled()) std::this_thread::sleep_for(milliseconds(2));
    return grpc::Status::CANCELLED;
  }));
  ClientOptions options = QuickOptions();
  options.keepalive_interval = milliseconds(200);
  options.keepalive_timeout = milliseconds(100);
  const Clock::time_point start = Clock::now();
  const auto outcome = ConnectTo(server.target(), options)->UploadScan(StrewnScan());
  EXPECT_TRUE(outcome.ok()) << outcome.status();
  EXPECT_EQ(num_streams, 2);
  EXPECT_GE(Clock::now() - start, milliseconds(300));
  EXPECT_LT(Clock::now() - start, milliseconds(5000));
}

TEST(UploadTest, IsCancelled) {
  std::stop_source source;
  const ScriptedServer server(WithUpload([&](auto& context, auto& stream) {
    v1::UploadScanRequest request;
    stream.Read(&request);
    source.request_stop();
    while (!context.IsCancelled()) std::this_thread::sleep_for(milliseconds(2));
    return grpc::Status::CANCELLED;
  }));
  TransferOptions options = Raw();
  options.cancellation = source.get_token();
  const Clock::time_point start = Clock::now();
  EXPECT_TRUE(absl::IsCancelled(ConnectTo(server.target())->UploadScan(StrewnScan(), options).status()));
  EXPECT_LT(Clock::now() - start, milliseconds(3000));
}

TEST(UploadTest, RefusesOptionsThatMakeNoSense) {
  const ScriptedServer server({});
  const auto client = ConnectTo(server.target());
  TransferOptions options;
  options.chunk_bytes = 0;
  EXPECT_TRUE(absl::IsInvalidArgument(client->UploadScan(StrewnScan(), options).status()));
  for (const double share : {0.0, -1.0, 1.5, std::numeric_limits<double>::quiet_NaN()}) {
    options = {};
    options.max_resend_share = share;
    EXPECT_TRUE(absl::IsInvalidArgument(client->UploadScan(StrewnScan(), options).status())) << share;
  }
  options = {};
  options.encoding.max_error_m = -1.0;
  EXPECT_TRUE(absl::IsInvalidArgument(client->UploadScan(StrewnScan(), options).status()));
}

}  // namespace
}  // namespace curvereg
