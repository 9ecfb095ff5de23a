// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/traverses/map_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <map>
#include <optional>
#include <string>
#include <thread>

#include "absl/strings/str_cat.h"
#include "core/base/parallel.h"
#include "tests/server/traverses/fake_traverses.h"
#include "tests/server/traverses/stream_server.h"
#include "tests/testing/matchers.h"
#include "wire/digest.h"
#include "wire/error.h"
#include "wire/status_mapping.h"

namespace curvereg::testing {
namespace {

constexpr uint64_t kMapBytes = 200'000;

class TextMap final : public server::MapFile {
 public:
  TextMap(uint64_t version, std::string bytes) : bytes_(std::move(bytes)) {
    header_.set_version(version);
    header_.set_payload_bytes(bytes_.size());
    *header_.mutable_payload_digest() = Xxh3(bytes_);
  }
  const v1::MapHeader& header() const override { return header_; }
  absl::StatusOr<std::string> Read(uint64_t offset, uint64_t size) const override {
    return bytes_.substr(offset, size);
  }

 private:
  const std::string bytes_;
  v1::MapHeader header_;
};

// Maps are text that tells the request and the version.
class TextMaps final : public server::MapBuilder {
 public:
  absl::StatusOr<std::shared_ptr<const server::MapFile>> Build(const server::MapRequest& request,
                                                               const server::MapSource& source,
                                                               const Stop& stop) override {
    ++num_builds;
    while (is_slow) {
      if (stop.Requested()) return absl::CancelledError("asked to stop");
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    if (request.cell_m > 10) return wire::FieldError("cell_m", "is too large");
    if (meets) {
      std::atomic<int> num_there = 0;
      ParallelFor(2, [&](int) {
        ++num_there;
        if (WaitUntil([&] { return num_there == 2; })) has_met = true;
      });
    }
    std::string text;
    while (text.size() < num_bytes) absl::StrAppend(&text, request.cell_m, " ", source.version, " ", text.size(), "\n");
    built[source.version] = std::make_shared<TextMap>(source.version, text.substr(0, num_bytes));
    return built[source.version];
  }
  std::shared_ptr<const server::MapFile> FindBuilt(const server::MapRequest&, uint64_t version) override {
    return built.contains(version) ? built[version] : nullptr;
  }
  void Forget(const std::string&) override { built.clear(); }

  std::map<uint64_t, std::shared_ptr<const server::MapFile>> built;
  uint64_t num_bytes = kMapBytes;
  std::atomic<int> num_builds = 0;
  std::atomic<bool> is_slow = false;
  bool meets = false;  // builds with two tasks that wait for each other
  std::atomic<bool> has_met = false;
};

struct DownloadedMap {
  std::optional<v1::MapHeader> header;
  std::string bytes;
  absl::Status status;
};

DownloadedMap Download(v1::TraverseService::Stub& stub, const v1::DownloadMapRequest& request) {
  grpc::ClientContext context;
  const auto stream = stub.DownloadMap(&context, request);
  DownloadedMap map;
  v1::DownloadMapResponse response;
  while (stream->Read(&response)) {
    if (response.has_header()) {
      EXPECT_FALSE(map.header.has_value());
      map.header = response.header();
      continue;
    }
    EXPECT_TRUE(map.header.has_value());
    EXPECT_EQ(response.chunk().offset(), request.offset() + map.bytes.size());
    EXPECT_EQ(response.chunk().crc32c(), wire::Crc32c(response.chunk().data()));
    map.bytes += response.chunk().data();
  }
  map.status = wire::FromGrpcStatus(stream->Finish());
  return map;
}

class MapStreamTest : public ::testing::Test {
 protected:
  DownloadedMap Get(uint64_t offset = 0, std::optional<uint64_t> version = std::nullopt) {
    v1::DownloadMapRequest request;
    request.set_name(FakeTraverses::kName);
    request.set_cell_m(0.5);
    request.set_offset(offset);
    if (version.has_value()) request.set_version(*version);
    return Download(*stub_, request);
  }

  FakeTraverses traverses_;
  TextMaps maps_;
  StreamServer server_{traverses_, {.scans = {}, .maps = &maps_}};
  std::unique_ptr<v1::TraverseService::Stub> stub_ = server_.NewStub();
};

TEST_F(MapStreamTest, TellsWhatTheMapIsAndItsBytes) {
  const DownloadedMap map = Get();
  ASSERT_THAT(map.status, IsOk());
  ASSERT_TRUE(map.header.has_value());
  EXPECT_EQ(map.header->version(), 1);
  EXPECT_EQ(map.header->payload_bytes(), kMapBytes);
  EXPECT_EQ(map.bytes.size(), kMapBytes);
  EXPECT_TRUE(wire::SameDigest(Xxh3(map.bytes), map.header->payload_digest()));
  EXPECT_THAT(map.bytes, ::testing::StartsWith("0.5 1 0\n"));
}

TEST_F(MapStreamTest, BuildsWithMoreThanOneThread) {
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "one processor";
  maps_.meets = true;
  ASSERT_THAT(Get().status, IsOk());
  EXPECT_TRUE(maps_.has_met);
}

TEST_F(MapStreamTest, GoesOnFromAnyOffset) {
  const std::string whole = Get().bytes;
  for (const uint64_t offset : {uint64_t{1}, uint64_t{65'536}, uint64_t{100'001}, kMapBytes - 1, kMapBytes}) {
    const DownloadedMap rest = Get(offset, 1);
    ASSERT_THAT(rest.status, IsOk());
    EXPECT_EQ(rest.header->payload_bytes(), kMapBytes);
    EXPECT_EQ(whole.substr(0, offset) + rest.bytes, whole);
  }
  EXPECT_EQ(maps_.num_builds, 1) << "what is built is used again";
}

TEST_F(MapStreamTest, GoesOnWithAnOlderVersionThatIsStillThere) {
  const std::string whole = Get().bytes;
  traverses_.set_source_version(2);
  EXPECT_EQ(whole.substr(0, 1000) + Get(1000, 1).bytes, whole);
  EXPECT_EQ(Get().header->version(), 2);
  maps_.built.erase(1);
  const DownloadedMap gone = Get(1000, 1);
  EXPECT_THAT(gone.status, HasCode(absl::StatusCode::kOutOfRange));
  EXPECT_EQ(MetadataOf(gone.status, "committed_offset"), "0");
  EXPECT_FALSE(gone.header.has_value());
}

TEST_F(MapStreamTest, BuildsTheNewestVersionAgainWhenItIsGone) {
  const std::string whole = Get().bytes;
  maps_.built.clear();
  EXPECT_EQ(whole.substr(0, 1000) + Get(1000, 1).bytes, whole);
}

TEST_F(MapStreamTest, RefusesWhatCannotBe) {
  EXPECT_EQ(ReasonText(Get(1000).status), "INVALID_FIELD") << "of which version?";
  EXPECT_EQ(ReasonText(Get(kMapBytes + 1, 1).status), "OFFSET_OUT_OF_RANGE");
  EXPECT_EQ(ReasonText(Get(0, 7).status), "OFFSET_OUT_OF_RANGE");
  v1::DownloadMapRequest request;
  request.set_name("traverses/other");
  EXPECT_EQ(ReasonText(Download(*stub_, request).status), "TRAVERSE_NOT_FOUND");
  request.set_version(1);
  EXPECT_EQ(ReasonText(Download(*stub_, request).status), "TRAVERSE_NOT_FOUND");
  request.set_name(FakeTraverses::kName);
  request.clear_version();
  request.set_cell_m(11);
  EXPECT_EQ(ReasonText(Download(*stub_, request).status), "INVALID_FIELD");
}

TEST_F(MapStreamTest, TellsAnEmptyMap) {
  maps_.num_bytes = 0;
  const DownloadedMap map = Get();
  EXPECT_THAT(map.status, IsOk());
  EXPECT_EQ(map.header->payload_bytes(), 0);
  EXPECT_TRUE(map.bytes.empty());
}

TEST_F(MapStreamTest, StopsBuildingForACallerThatIsGone) {
  maps_.is_slow = true;
  {
    v1::DownloadMapRequest request;
    request.set_name(FakeTraverses::kName);
    grpc::ClientContext context;
    const auto stream = stub_->DownloadMap(&context, request);
    ASSERT_TRUE(WaitUntil([&] { return maps_.num_builds == 1; }));
    context.TryCancel();
    EXPECT_EQ(stream->Finish().error_code(), grpc::StatusCode::CANCELLED);
  }
  EXPECT_TRUE(WaitUntil([&] { return server_.OpenCalls("DownloadMap") == 0; }));
  EXPECT_TRUE(WaitUntil([&] { return server_.pool().Statistics().num_running == 0; }));
}

}  // namespace
}  // namespace curvereg::testing
