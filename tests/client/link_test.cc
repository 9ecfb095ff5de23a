// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The client and the real server over bad links.
#include <chrono>
#include <cstdio>
#include <memory>
#include <stop_token>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/client.h"
#include "server/server.h"
#include "tests/testing/impairment_proxy.h"
#include "tests/testing/scenes.h"
#include "tests/testing/test_data.h"

namespace curvereg {
namespace {

using std::chrono::milliseconds;
using testing::Direction;
using testing::ImpairmentProxy;
using testing::LinkOptions;
using Clock = std::chrono::steady_clock;

class LinkTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new testing::TemporaryFolder;
    server::ServerConfig config;
    config.listen = "127.0.0.1:0";
    config.ops_listen = "";
    config.data_dir = folder_->File("data");
    auto server = server::Server::Start(config);
    ASSERT_TRUE(server.ok()) << server.status();
    server_ = server->release();
  }
  static void TearDownTestSuite() {
    delete server_;
    delete folder_;
  }

  void Open(const LinkOptions& link, const ClientOptions& options = {}) {
    auto proxy = ImpairmentProxy::Start(server_->port(), link);
    ASSERT_TRUE(proxy.ok()) << proxy.status();
    proxy_ = *std::move(proxy);
    auto client = Client::Connect(proxy_->target(), options);
    ASSERT_TRUE(client.ok()) << client.status();
    client_ = *std::move(client);
  }

  static inline testing::TemporaryFolder* folder_ = nullptr;
  static inline server::Server* server_ = nullptr;
  std::unique_ptr<ImpairmentProxy> proxy_;
  std::unique_ptr<Client> client_;
};

// No two tests may upload the same scan, or the second finds it there.
Scan ScanOfBytes(int num_bytes, uint64_t seed) {
  return {testing::PatchPoints({.side_m = 40, .noise_m = 1.0}, num_bytes / 12, seed), std::nullopt};
}

TransferOptions Raw() {
  TransferOptions options;
  options.encoding.kind = TransferEncoding::Kind::kRaw;
  return options;
}

double ResentShare(const TransferProgress& transfer) {
  return static_cast<double>(transfer.bytes_resent) / static_cast<double>(transfer.bytes_total);
}

TEST_F(LinkTest, UploadsAndDownloadsBitForBit) {
  Open({});
  const Scan scan = ScanOfBytes(12'000'000, 1);
  const auto outcome = client_->UploadScan(scan, Raw());
  ASSERT_TRUE(outcome.ok()) << outcome.status();
  EXPECT_EQ(outcome->scan.num_points, scan.points.size());
  EXPECT_EQ(outcome->scan.content_digest, ScanDigest(scan));
  const auto again = client_->UploadScan(scan, Raw());
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_TRUE(again->already_stored);
  EXPECT_EQ(again->scan.name, outcome->scan.name);
  const auto loaded = client_->DownloadScan(outcome->scan.name);
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  EXPECT_EQ(loaded->points, scan.points);
}

// The promised case: 600 ms round trip, 2 Mbit/s, cut every 20 s, 3 MB.
TEST_F(LinkTest, BringsThreeMegabytesOverAGeostationaryLinkThatIsCut) {
  Open({.one_way_delay = milliseconds(300),
        .bytes_per_second = 2e6 / 8,
        .cut_every = milliseconds(20'000),
        .outage = milliseconds(1000)});
  const Clock::time_point start = Clock::now();
  const auto outcome = client_->UploadScan(ScanOfBytes(3'000'000, 2), Raw());
  ASSERT_TRUE(outcome.ok()) << outcome.status();
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  RecordProperty("seconds", std::to_string(seconds));
  RecordProperty("resent_share", std::to_string(ResentShare(outcome->transfer)));
  std::printf("3 MB in %.1f s, %d resumes, %.2f %% sent again, %llu bytes over the link\n", seconds,
              outcome->transfer.num_resumes, 100.0 * ResentShare(outcome->transfer),
              static_cast<unsigned long long>(proxy_->statistics().bytes_to_server));
  EXPECT_GE(outcome->transfer.num_resumes, 1) << "no cut fell into the transfer";
  EXPECT_LE(ResentShare(outcome->transfer), 0.05);
  // Counted on the link itself, with all headers.
  EXPECT_LE(static_cast<double>(proxy_->statistics().bytes_to_server), 1.06 * 3'000'000);
  EXPECT_LT(seconds, 90.0);
}

TEST_F(LinkTest, AnUploadSurvivesFrequentCutsOnAQuickLink) {
  Open({.one_way_delay = milliseconds(5), .bytes_per_second = 4e6, .cut_every = milliseconds(400)});
  const Scan scan = ScanOfBytes(6'000'000, 3);
  const auto outcome = client_->UploadScan(scan, Raw());
  ASSERT_TRUE(outcome.ok()) << outcome.status();
  EXPECT_GE(outcome->transfer.num_resumes, 2);
  EXPECT_EQ(outcome->scan.content_digest, ScanDigest(scan));
}

TEST_F(LinkTest, ANewClientGoesOnFromWhereADeadOneStopped) {
  const Scan scan = ScanOfBytes(6'000'000, 8);
  std::stop_source death;
  uint64_t committed = 0;
  TransferOptions options = Raw();
  options.cancellation = death.get_token();
  options.progress = [&](const TransferProgress& progress) {
    committed = progress.bytes_done;
    if (2 * committed >= progress.bytes_total) death.request_stop();
  };
  Open({.one_way_delay = milliseconds(5), .bytes_per_second = 8e6});
  EXPECT_TRUE(absl::IsCancelled(client_->UploadScan(scan, options).status()));
  client_.reset();
  ASSERT_GE(committed, 3'000'000U);
  ASSERT_LT(committed, 5'900'000U);
  Open({});
  const auto outcome = client_->UploadScan(scan, Raw());
  ASSERT_TRUE(outcome.ok()) << outcome.status();
  EXPECT_FALSE(outcome->already_stored);
  EXPECT_EQ(outcome->scan.content_digest, ScanDigest(scan));
  // Counted on the link itself, with all headers: of what was committed nothing came again.
  const uint64_t sent = proxy_->statistics().bytes_to_server;
  std::printf("%llu bytes committed before, %llu over the link afterwards\n",
              static_cast<unsigned long long>(committed), static_cast<unsigned long long>(sent));
  EXPECT_LE(static_cast<double>(sent), 1.01 * (6'000'000.0 - static_cast<double>(committed)) + 10'000.0);
}

TEST_F(LinkTest, TwoClientsThatUploadTheSameBothSucceed) {
  Open({.one_way_delay = milliseconds(5), .bytes_per_second = 8e6});
  const Scan scan = ScanOfBytes(3'000'000, 9);
  absl::StatusOr<UploadOutcome> first, second;
  {
    const std::jthread other([&] { first = client_->UploadScan(scan, Raw()); });
    second = client_->UploadScan(scan, Raw());
  }
  ASSERT_TRUE(first.ok()) << first.status();
  ASSERT_TRUE(second.ok()) << second.status();
  EXPECT_EQ(first->scan.name, second->scan.name);
  EXPECT_NE(first->already_stored, second->already_stored) << "stored once";
}

TEST_F(LinkTest, ADownloadSurvivesFrequentCuts) {
  Open({.one_way_delay = milliseconds(5), .bytes_per_second = 4e6, .cut_every = milliseconds(700)});
  const Scan scan = ScanOfBytes(5'000'000, 4);
  const auto direct = Client::Connect("127.0.0.1:" + std::to_string(server_->port()));
  ASSERT_TRUE(direct.ok()) << direct.status();
  const auto outcome = (*direct)->UploadScan(scan, Raw());
  ASSERT_TRUE(outcome.ok()) << outcome.status();
  TransferOptions options;
  options.chunk_bytes = 64 * 1024;
  int num_resumes = 0;
  options.progress = [&](const TransferProgress& progress) { num_resumes = progress.num_resumes; };
  const auto loaded = client_->DownloadScan(outcome->scan.name, options);
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  EXPECT_EQ(loaded->points, scan.points);
  EXPECT_GE(num_resumes, 1);
}

TEST_F(LinkTest, AnUploadNoticesAPulledCable) {
  ClientOptions options;
  options.keepalive_interval = milliseconds(1000);
  options.keepalive_timeout = milliseconds(500);
  Open({.bytes_per_second = 2e6}, options);
  const Scan scan = ScanOfBytes(3'000'000, 5);
  TransferOptions transfer = Raw();
  bool pulled = false;
  transfer.progress = [&](const TransferProgress& progress) {
    if (!pulled && progress.bytes_done > 500'000) proxy_->Abandon();
    pulled = pulled || progress.bytes_done > 500'000;
  };
  const Clock::time_point start = Clock::now();
  const auto outcome = client_->UploadScan(scan, transfer);
  ASSERT_TRUE(outcome.ok()) << outcome.status();
  EXPECT_GE(outcome->transfer.num_resumes, 1);
  EXPECT_EQ(outcome->scan.content_digest, ScanDigest(scan));
  EXPECT_LT(Clock::now() - start, milliseconds(20'000));
}

TEST_F(LinkTest, AStallThatEndsCostsNothing) {
  Open({.bytes_per_second = 2e6});
  const Scan scan = ScanOfBytes(2'000'000, 6);
  TransferOptions transfer = Raw();
  std::jthread resumer;
  transfer.progress = [&](const TransferProgress& progress) {
    if (resumer.joinable() || progress.bytes_done < 500'000) return;
    proxy_->Stall();
    resumer = std::jthread([this] {
      std::this_thread::sleep_for(milliseconds(700));
      proxy_->Resume();
    });
  };
  const auto outcome = client_->UploadScan(scan, transfer);
  ASSERT_TRUE(outcome.ok()) << outcome.status();
  EXPECT_EQ(outcome->transfer.num_resumes, 0);
  EXPECT_EQ(outcome->transfer.bytes_resent, 0U);
}

TEST_F(LinkTest, ADamagedByteIsSentAgain) {
  // Wherever it falls: into points, into a header of HTTP/2, into a checksum.
  for (const uint64_t offset : {uint64_t{100'000}, uint64_t{200'001}, uint64_t{300'002}, uint64_t{444'444}}) {
    Open({});
    proxy_->CorruptByte(Direction::kToServer, offset);
    const Scan scan = ScanOfBytes(900'000, 100 + offset);
    const auto outcome = client_->UploadScan(scan, Raw());
    ASSERT_TRUE(outcome.ok()) << outcome.status();
    EXPECT_GE(outcome->transfer.num_resumes, 1) << offset;
    EXPECT_EQ(outcome->scan.content_digest, ScanDigest(scan)) << offset;
  }
}

TEST_F(LinkTest, ACallOutlivesACut) {
  Open({.one_way_delay = milliseconds(20)});
  proxy_->Cut(milliseconds(300));
  const auto status = client_->Status();
  EXPECT_TRUE(status.ok()) << status.status();
  EXPECT_GE(status->round_trip, milliseconds(40));
}

}  // namespace
}  // namespace curvereg
