// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Downloads from servers that misbehave, and servers that say no.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/client.h"
#include "tests/client/scripted_server.h"
#include "wire/digest.h"
#include "wire/point_codec.h"

namespace curvereg {
namespace {

using std::chrono::milliseconds;
using testing::ConnectTo;
using testing::QuickOptions;
using testing::Refusal;
using testing::Script;
using testing::ScriptedServer;
using testing::StrewnScan;

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
  bool SendChunk(Script::DownloadWriter& writer, uint64_t offset, uint64_t size = kChunkBytes,
                 bool damaged = false) const {
    v1::DownloadScanResponse response;
    v1::PayloadChunk& chunk = *response.mutable_chunk();
    chunk.set_offset(offset);
    chunk.set_data(cloud.data().substr(offset, size));
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
  const Scan scan = StrewnScan();
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
  TransferOptions transfer;
  uint64_t last = 0;
  transfer.progress = [&](const TransferProgress& progress) {
    EXPECT_GT(progress.bytes_done, last);
    EXPECT_EQ(progress.bytes_total, stored.cloud.data().size());
    last = progress.bytes_done;
  };
  const auto loaded = ConnectTo(server.target())->DownloadScan("scans/a", transfer);
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  EXPECT_EQ(loaded->points, scan.points);
  EXPECT_EQ(last, stored.cloud.data().size());
  // gRPC drops chunks that were not read when an error ends the stream, so more streams than four may be needed.
  ASSERT_GE(offsets.size(), 4U);
  for (size_t i = 1; i < offsets.size(); ++i) {
    EXPECT_EQ(offsets[i] % Stored::kChunkBytes, 0U);
    EXPECT_GE(offsets[i], offsets[i - 1]);
    EXPECT_LE(offsets[i], offsets[i - 1] + 3 * Stored::kChunkBytes);
  }
}

TEST(DownloadTest, AsksAgainForADamagedChunk) {
  const Scan scan = StrewnScan();
  const Stored stored(scan);
  std::vector<uint64_t> offsets;
  const ScriptedServer server(WithDownload([&](auto&, const auto& request, auto& writer) {
    offsets.push_back(request.offset());
    stored.SendScan(writer);
    for (uint64_t at = request.offset(); at < stored.cloud.data().size(); at += Stored::kChunkBytes) {
      if (!stored.SendChunk(writer, at, Stored::kChunkBytes, offsets.size() == 1 && at == 2 * Stored::kChunkBytes))
        break;
    }
    return grpc::Status::OK;
  }));
  const auto loaded = ConnectTo(server.target())->DownloadScan("scans/a");
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  EXPECT_EQ(loaded->points, scan.points);
  EXPECT_EQ(offsets, (std::vector<uint64_t>{0, 2 * Stored::kChunkBytes}));
}

TEST(DownloadTest, RefusesAPayloadWithoutItsDigest) {
  Stored stored(StrewnScan());
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
  Stored stored(StrewnScan());
  stored.description.set_payload_bytes(uint64_t{1} << 60);
  stored.description.mutable_header()->set_point_count((uint64_t{1} << 60) / 12);
  const ScriptedServer server(WithDownload([&](auto&, const auto&, auto& writer) {
    stored.SendScan(writer);
    return grpc::Status::OK;
  }));
  EXPECT_FALSE(ConnectTo(server.target())->DownloadScan("scans/a").ok());
}

TEST(DownloadTest, AServerThatFallsSilentIsAskedAgain) {
  const Stored stored(StrewnScan());
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

// Chunks of the size asked for take longer than the client's patience, smaller ones do not.
TEST(DownloadTest, GetsThroughASlowLink) {
  constexpr uint64_t kBytesPerMillisecond = 250;
  const Scan scan = StrewnScan();
  const Stored stored(scan);
  const ScriptedServer server(WithDownload([&](auto& context, const auto& request, auto& writer) {
    stored.SendScan(writer);
    for (uint64_t at = request.offset(); at < stored.cloud.data().size(); at += request.chunk_bytes()) {
      const uint64_t size = std::min<uint64_t>(request.chunk_bytes(), stored.cloud.data().size() - at);
      for (uint64_t i = 0; i < size / kBytesPerMillisecond && !context.IsCancelled(); ++i) {
        std::this_thread::sleep_for(milliseconds(1));
      }
      if (context.IsCancelled()) return grpc::Status::CANCELLED;
      stored.SendChunk(writer, at, size);
    }
    return grpc::Status::OK;
  }));
  ClientOptions options = QuickOptions();
  options.keepalive_interval = milliseconds(200);
  options.keepalive_timeout = milliseconds(100);
  const auto loaded = ConnectTo(server.target(), options)->DownloadScan("scans/a");
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  EXPECT_EQ(loaded->points.size(), scan.points.size());
}

}  // namespace
}  // namespace curvereg
