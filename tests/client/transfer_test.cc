// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Uploads and downloads against servers that misbehave, and servers that say no.
#include <atomic>
#include <chrono>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/client.h"
#include "tests/client/scripted_server.h"
#include "tests/testing/scenes.h"
#include "wire/digest.h"
#include "wire/error.h"
#include "wire/point_codec.h"
#include "wire/status_mapping.h"

namespace curvereg {
namespace {

using std::chrono::milliseconds;
using testing::ConnectTo;
using testing::QuickOptions;
using testing::Script;
using testing::ScriptedServer;
using Clock = std::chrono::steady_clock;

Scan SmallScan(int num_points = 20'000) {
  return {testing::PatchPoints({.noise_m = 0.1}, num_points, 3), std::nullopt};
}

grpc::Status Refusal(v1::ErrorReason reason) { return wire::ToGrpcStatus(wire::MakeError(reason, "refused"), "r"); }

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
  const Scan scan = SmallScan(300'000);
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
  EXPECT_EQ(memory.upload.size(), std::string("uploads/").size() + 36);
  ASSERT_FALSE(told.empty());
  for (size_t i = 1; i < told.size(); ++i) EXPECT_GT(told[i].bytes_done, told[i - 1].bytes_done);
  EXPECT_EQ(told.back().bytes_done, memory.bytes.size());
}

TEST(UploadTest, GoesOnUnderTheSameNameAfterCuts) {
  UploadMemory memory;
  memory.cut_after = 3;
  const ScriptedServer server(WithUpload([&](auto&, auto& stream) { return Keep(memory, stream); }));
  const Scan scan = SmallScan();
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
  const Scan scan = SmallScan();
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
  const auto outcome = ConnectTo(server.target())->UploadScan(SmallScan(), options);
  ASSERT_TRUE(outcome.ok()) << outcome.status();
  EXPECT_TRUE(outcome->already_stored);
  EXPECT_EQ(outcome->scan.name, "scans/known");
}

TEST(UploadTest, DoesNotFightAnotherWriter) {
  std::atomic<int> num_streams = 0;
  const ScriptedServer server(WithUpload([&](auto&, auto&) {
    ++num_streams;
    return Refusal(v1::ERROR_REASON_WRITER_REPLACED);
  }));
  const auto outcome = ConnectTo(server.target())->UploadScan(SmallScan());
  EXPECT_TRUE(absl::IsAborted(outcome.status())) << outcome.status();
  EXPECT_EQ(ErrorReasonName(outcome.status()), "WRITER_REPLACED");
  EXPECT_EQ(num_streams, 1);
}

TEST(UploadTest, GivesUpWhenThereIsNoProgress) {
  std::atomic<int> num_streams = 0;
  const ScriptedServer server(WithUpload([&](auto&, auto&) {
    ++num_streams;
    return grpc::Status(grpc::UNAVAILABLE, "cut");
  }));
  ClientOptions options = QuickOptions();
  options.retry.max_attempts = 3;
  EXPECT_TRUE(absl::IsUnavailable(ConnectTo(server.target(), options)->UploadScan(SmallScan()).status()));
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
    return ConnectTo(server.target(), options)->UploadScan(SmallScan()).status();
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
  const auto outcome = ConnectTo(server.target(), options)->UploadScan(SmallScan());
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
  EXPECT_TRUE(absl::IsCancelled(ConnectTo(server.target())->UploadScan(SmallScan(), options).status()));
  EXPECT_LT(Clock::now() - start, milliseconds(3000));
}

TEST(UploadTest, RefusesOptionsThatMakeNoSense) {
  const ScriptedServer server({});
  const auto client = ConnectTo(server.target());
  TransferOptions options;
  options.chunk_bytes = 0;
  EXPECT_TRUE(absl::IsInvalidArgument(client->UploadScan(SmallScan(), options).status()));
  for (const double share : {0.0, -1.0, 1.5, std::numeric_limits<double>::quiet_NaN()}) {
    options = {};
    options.max_resend_share = share;
    EXPECT_TRUE(absl::IsInvalidArgument(client->UploadScan(SmallScan(), options).status())) << share;
  }
  options = {};
  options.encoding.max_error_m = -1.0;
  EXPECT_TRUE(absl::IsInvalidArgument(client->UploadScan(SmallScan(), options).status()));
}

// What a server needs to answer a download.
struct Stored {
  explicit Stored(const Scan& scan) : cloud(*wire::EncodeScan(scan)) {
    *description.mutable_header() = cloud.header();
    description.set_payload_bytes(cloud.data().size());
    *description.mutable_payload_digest() = wire::DigestOf(v1::DIGEST_ALGORITHM_XXH3_128, cloud.data());
  }
  bool SendScan(Script::DownloadWriter& writer) const {
    v1::DownloadScanResponse response;
    *response.mutable_scan() = description;
    return writer.Write(response);
  }
  bool SendChunk(Script::DownloadWriter& writer, uint64_t offset, bool damaged = false) const {
    v1::DownloadScanResponse response;
    v1::PayloadChunk& chunk = *response.mutable_chunk();
    chunk.set_offset(offset);
    chunk.set_data(cloud.data().substr(offset, kChunkBytes));
    chunk.set_crc32c(wire::Crc32c(chunk.data()));
    if (damaged) (*chunk.mutable_data())[0] ^= 1;
    return writer.Write(response);
  }
  static constexpr uint64_t kChunkBytes = 20'000;
  v1::PointCloud cloud;
  v1::Scan description;
};

Script WithDownload(decltype(Script::download_scan) function) {
  Script script;
  script.download_scan = std::move(function);
  return script;
}

TEST(DownloadTest, ResumesFromWhatItHas) {
  const Scan scan = SmallScan();
  const Stored stored(scan);
  std::vector<uint64_t> offsets;
  const ScriptedServer server(WithDownload([&](auto&, const auto& request, auto& writer) {
    EXPECT_EQ(request.name(), "scans/a");
    offsets.push_back(request.offset());
    stored.SendScan(writer);
    uint64_t end = request.offset() + 3 * Stored::kChunkBytes;
    for (uint64_t at = request.offset(); at < std::min<uint64_t>(end, stored.cloud.data().size());) {
      stored.SendChunk(writer, at);
      at += Stored::kChunkBytes;
    }
    return end < stored.cloud.data().size() ? grpc::Status(grpc::UNAVAILABLE, "cut") : grpc::Status::OK;
  }));
  ClientOptions options = QuickOptions();
  options.retry.max_attempts = 2;
  TransferOptions transfer;
  uint64_t last = 0;
  transfer.progress = [&](const TransferProgress& progress) {
    EXPECT_GT(progress.bytes_done, last);
    EXPECT_EQ(progress.bytes_total, stored.cloud.data().size());
    last = progress.bytes_done;
  };
  const auto loaded = ConnectTo(server.target(), options)->DownloadScan("scans/a", transfer);
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  EXPECT_EQ(loaded->points, scan.points);
  EXPECT_EQ(last, stored.cloud.data().size());
  ASSERT_EQ(offsets.size(), 4U);
  for (size_t i = 0; i < offsets.size(); ++i) EXPECT_EQ(offsets[i], i * 3 * Stored::kChunkBytes);
}

TEST(DownloadTest, AsksAgainForADamagedChunk) {
  const Scan scan = SmallScan();
  const Stored stored(scan);
  std::vector<uint64_t> offsets;
  const ScriptedServer server(WithDownload([&](auto&, const auto& request, auto& writer) {
    offsets.push_back(request.offset());
    stored.SendScan(writer);
    for (uint64_t at = request.offset(); at < stored.cloud.data().size(); at += Stored::kChunkBytes) {
      if (!stored.SendChunk(writer, at, offsets.size() == 1 && at == 2 * Stored::kChunkBytes)) break;
    }
    return grpc::Status::OK;
  }));
  const auto loaded = ConnectTo(server.target())->DownloadScan("scans/a");
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  EXPECT_EQ(loaded->points, scan.points);
  EXPECT_EQ(offsets, (std::vector<uint64_t>{0, 2 * Stored::kChunkBytes}));
}

TEST(DownloadTest, RefusesAPayloadWithoutItsDigest) {
  Stored stored(SmallScan());
  stored.description.mutable_payload_digest()->mutable_value()->front() ^= 1;
  const ScriptedServer server(WithDownload([&](auto&, const auto&, auto& writer) {
    stored.SendScan(writer);
    for (uint64_t at = 0; at < stored.cloud.data().size(); at += Stored::kChunkBytes) stored.SendChunk(writer, at);
    return grpc::Status::OK;
  }));
  const auto loaded = ConnectTo(server.target())->DownloadScan("scans/a");
  EXPECT_EQ(ErrorReasonName(loaded.status()), "DIGEST_MISMATCH") << loaded.status();
}

TEST(DownloadTest, TellsTheServersRefusal) {
  const ScriptedServer server(
      WithDownload([](auto&, const auto&, auto&) { return Refusal(v1::ERROR_REASON_SCAN_NOT_FOUND); }));
  EXPECT_EQ(ErrorReasonName(ConnectTo(server.target())->DownloadScan("scans/a").status()), "SCAN_NOT_FOUND");
}

TEST(DownloadTest, TakesNoMemoryOnTheServersWord) {
  Stored stored(SmallScan());
  stored.description.set_payload_bytes(uint64_t{1} << 60);
  stored.description.mutable_header()->set_point_count((uint64_t{1} << 60) / 12);
  const ScriptedServer server(WithDownload([&](auto&, const auto&, auto& writer) {
    stored.SendScan(writer);
    return grpc::Status::OK;
  }));
  EXPECT_FALSE(ConnectTo(server.target())->DownloadScan("scans/a").ok());
}

TEST(DownloadTest, AServerThatFallsSilentIsAskedAgain) {
  const Stored stored(SmallScan());
  std::atomic<int> num_streams = 0;
  const ScriptedServer server(WithDownload([&](auto& context, const auto& request, auto& writer) {
    stored.SendScan(writer);
    if (++num_streams == 1) {
      while (!context.IsCancelled()) std::this_thread::sleep_for(milliseconds(2));
      return grpc::Status::CANCELLED;
    }
    for (uint64_t at = request.offset(); at < stored.cloud.data().size(); at += Stored::kChunkBytes) {
      stored.SendChunk(writer, at);
    }
    return grpc::Status::OK;
  }));
  ClientOptions options = QuickOptions();
  options.keepalive_interval = milliseconds(200);
  options.keepalive_timeout = milliseconds(100);
  const auto loaded = ConnectTo(server.target(), options)->DownloadScan("scans/a");
  EXPECT_TRUE(loaded.ok()) << loaded.status();
  EXPECT_EQ(num_streams, 2);
}

}  // namespace
}  // namespace curvereg
