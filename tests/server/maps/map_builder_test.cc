// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/maps/map_builder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <new>
#include <thread>
#include <vector>

#include "core/mapping/point_map.h"
#include "tests/core/mapping/map_scenes.h"
#include "tests/server/store/store_testing.h"
#include "tests/server/store/throwing_store.h"
#include "wire/point_codec.h"

namespace curvereg::server {
namespace {

using testing::HasCode;
using ::testing::IsEmpty;
using testing::IsOk;
using testing::MapScene;
using ::testing::SizeIs;

constexpr char kTraverse[] = "traverses/yard-1";

// A traverse of a few stored scans.
class MapBuilderTest : public ::testing::Test {
 protected:
  MapBuilderTest() {
    for (std::size_t i = 0; i < scene_.scans.size(); ++i) source_.scan_ids.push_back(Add(*scene_.scans[i]));
    source_.T_segment_scan = scene_.T_map_scan;
    builder_ = Open({});
  }

  std::string Add(const Scan& scan) {
    absl::StatusOr<v1::PointCloud> cloud = wire::EncodeScan(scan);
    EXPECT_THAT(cloud, IsOk());
    const std::string& payload = cloud->data();
    const auto committed = Store(*store_, {"upload", cloud->header(), payload.size(), DigestOf(payload)}, payload);
    EXPECT_THAT(committed, IsOk());
    return committed.ok() ? committed->scan.id : "";
  }

  std::unique_ptr<MapBuilder> Open(const MapBuilder::Options& options) {
    MapEnvironment environment;
    environment.store = store_.get();
    environment.memory = &memory_;
    absl::StatusOr<std::unique_ptr<MapBuilder>> builder = MapBuilder::Open(folder_.path(), environment, options);
    EXPECT_THAT(builder, IsOk());
    return builder.ok() ? *std::move(builder) : nullptr;
  }

  std::shared_ptr<const MapFile> Build(const MapRequest& request) {
    absl::StatusOr<std::shared_ptr<const MapFile>> map = builder_->Build(request, source_, {});
    EXPECT_THAT(map, IsOk());
    return map.ok() ? *std::move(map) : nullptr;
  }

  std::vector<std::string> Files() const { return FilesBelow(folder_.File("maps")); }

  testing::TemporaryFolder folder_;
  std::unique_ptr<ScanStore> store_ = OpenStore(folder_.path());
  MemoryBudget memory_{uint64_t{256} << 20};
  const MapScene scene_ = testing::Strip(4, 3000);
  MapSource source_{.version = 7, .scan_ids = {}, .T_segment_scan = {}};
  std::unique_ptr<MapBuilder> builder_;
};

std::string PayloadOf(const MapFile& map) {
  const absl::StatusOr<std::string> bytes = map.Read(0, std::numeric_limits<uint32_t>::max());
  EXPECT_THAT(bytes, IsOk());
  return bytes.value_or("");
}

std::string PointBytes(const MapScene& scene, const PointMapOptions& options) {
  const std::vector<Eigen::Vector3f> points = testing::PointsOf(scene, options);
  return {reinterpret_cast<const char*>(points.data()), points.size() * sizeof(Eigen::Vector3f)};
}

TEST_F(MapBuilderTest, PointsAreThoseOfTheCore) {
  const auto map = Build({.traverse = kTraverse, .cell_m = 0.2});
  const std::string expected = PointBytes(scene_, {.cell_m = 0.2});
  ASSERT_GT(expected.size(), 12000U);
  const std::string payload = PayloadOf(*map);
  EXPECT_TRUE(payload == expected);
  EXPECT_EQ(map->header().version(), 7U);
  EXPECT_EQ(map->header().payload_bytes(), payload.size());
  EXPECT_EQ(map->header().cell_count(), payload.size() / 12);
  EXPECT_TRUE(wire::SameDigest(map->header().payload_digest(), DigestOf(payload)));
  EXPECT_EQ(memory_.reserved_bytes(), 0U);
}

TEST_F(MapBuilderTest, ElevationIsAnAsciiGrid) {
  const auto map = Build({.traverse = kTraverse, .kind = v1::MAP_KIND_ELEVATION_ASCII, .cell_m = 0.5});
  const std::string text = PayloadOf(*map);
  EXPECT_THAT(text, ::testing::StartsWith("ncols "));
  EXPECT_THAT(text, ::testing::HasSubstr("cellsize 0.500000\nNODATA_value -9999\n"));
  int columns = 0, rows = 0;
  ASSERT_EQ(std::sscanf(text.c_str(), "ncols %d nrows %d", &columns, &rows), 2);
  EXPECT_EQ(map->header().cell_count(), static_cast<uint64_t>(columns) * static_cast<uint64_t>(rows));
  EXPECT_TRUE(wire::SameDigest(map->header().payload_digest(), DigestOf(text)));
}

TEST_F(MapBuilderTest, IsReadInPieces) {
  const auto map = Build({.traverse = kTraverse});
  const std::string payload = PayloadOf(*map);
  std::string joined;
  while (joined.size() < payload.size()) {
    const absl::StatusOr<std::string> piece = map->Read(joined.size(), 1001);
    ASSERT_THAT(piece, IsOk());
    ASSERT_EQ(piece->size(), std::min<std::size_t>(1001, payload.size() - joined.size()));
    joined += *piece;
  }
  EXPECT_TRUE(joined == payload);
  EXPECT_THAT(map->Read(payload.size(), 10), IsOk());
  EXPECT_THAT(map->Read(payload.size() + 1, 1), HasReason(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE));
}

TEST_F(MapBuilderTest, BuildsEachMapOnce) {
  const auto first = Build({.traverse = kTraverse});
  // Without its scans it could not be built again.
  for (const std::string& id : source_.scan_ids) ASSERT_THAT(store_->DeleteScan(id), IsOk());
  EXPECT_TRUE(PayloadOf(*Build({.traverse = kTraverse})) == PayloadOf(*first));
  EXPECT_TRUE(PayloadOf(*Build({.traverse = kTraverse, .kind = v1::MAP_KIND_POINTS, .cell_m = 0.1})) ==
              PayloadOf(*first))
      << "the defaults spelt out";
  EXPECT_THAT(Files(), SizeIs(1));
  // After a restart, too.
  builder_ = Open({});
  EXPECT_TRUE(PayloadOf(*Build({.traverse = kTraverse})) == PayloadOf(*first));
  const auto not_found = HasReason(v1::ERROR_REASON_SCAN_NOT_FOUND);
  EXPECT_THAT(builder_->Build({.traverse = kTraverse, .cell_m = 0.3}, source_, {}), not_found);
  EXPECT_THAT(builder_->Build({.traverse = kTraverse, .remove_seen_through = true}, source_, {}), not_found);
  EXPECT_THAT(builder_->Build({.traverse = kTraverse, .segment = 1}, source_, {}), not_found);
  EXPECT_THAT(builder_->Build({.traverse = "traverses/other"}, source_, {}), not_found);
  EXPECT_THAT(builder_->Build({.traverse = kTraverse, .kind = v1::MAP_KIND_ELEVATION_ASCII}, source_, {}), not_found);
  source_.T_segment_scan[1].translation().x() += 1e-9;
  EXPECT_THAT(builder_->Build({.traverse = kTraverse}, source_, {}), not_found);
  EXPECT_THAT(Files(), SizeIs(1)) << "nothing unfinished is left";
}

TEST_F(MapBuilderTest, OptionsChangeTheMap) {
  const auto plain = Build({.traverse = kTraverse, .cell_m = 0.2});
  Scan spurious = *scene_.scans[0];
  for (int i = 0; i < 20; ++i) spurious.points.emplace_back(3.0F + 0.2F * static_cast<float>(i % 5), 0.3F, -0.2F);
  source_.scan_ids[0] = Add(spurious);
  const auto with_spurious = Build({.traverse = kTraverse, .cell_m = 0.2});
  const auto cleaned = Build({.traverse = kTraverse, .cell_m = 0.2, .remove_seen_through = true});
  EXPECT_GT(with_spurious->header().cell_count(), plain->header().cell_count());
  EXPECT_LT(cleaned->header().cell_count(), with_spurious->header().cell_count());
  EXPECT_THAT(Files(), SizeIs(3));
}

TEST_F(MapBuilderTest, FindsTheNewestOfAVersion) {
  const MapRequest request{.traverse = kTraverse};
  EXPECT_EQ(builder_->FindBuilt(request, 7), nullptr);
  const auto all = Build(request);
  source_.scan_ids.pop_back();
  source_.T_segment_scan.pop_back();
  const auto fewer = Build(request);
  ASSERT_NE(fewer->header().payload_bytes(), all->header().payload_bytes());
  const auto found = builder_->FindBuilt(request, 7);
  ASSERT_NE(found, nullptr);
  EXPECT_TRUE(wire::SameDigest(found->header().payload_digest(), fewer->header().payload_digest()));
  EXPECT_EQ(builder_->FindBuilt(request, 8), nullptr);
  EXPECT_EQ(builder_->FindBuilt({.traverse = kTraverse, .cell_m = 0.2}, 7), nullptr);
  EXPECT_EQ(builder_->FindBuilt({.traverse = kTraverse, .cell_m = -1.0}, 7), nullptr);
}

TEST_F(MapBuilderTest, ForgetsTheMapsOfATraverse) {
  const auto map = Build({.traverse = kTraverse});
  Build({.traverse = kTraverse, .cell_m = 0.2});
  Build({.traverse = "traverses/other"});
  builder_->Forget(kTraverse);
  EXPECT_THAT(Files(), SizeIs(1));
  EXPECT_EQ(builder_->FindBuilt({.traverse = kTraverse}, 7), nullptr);
  EXPECT_NE(builder_->FindBuilt({.traverse = "traverses/other"}, 7), nullptr);
  EXPECT_EQ(PayloadOf(*map).size(), map->header().payload_bytes()) << "who has it open reads on";
}

TEST_F(MapBuilderTest, RemovesTheLeastRecentlyUsed) {
  const uint64_t bytes = Build({.traverse = "traverses/a"})->header().payload_bytes();
  builder_ = Open({.max_stored_bytes = 3 * bytes + bytes / 2});
  Build({.traverse = "traverses/b"});
  Build({.traverse = "traverses/c"});
  Build({.traverse = "traverses/a"});  // used again
  Build({.traverse = "traverses/d"});
  EXPECT_THAT(Files(), SizeIs(3));
  EXPECT_EQ(builder_->FindBuilt({.traverse = "traverses/b"}, 7), nullptr);
  for (const char* kept : {"traverses/a", "traverses/c", "traverses/d"}) {
    EXPECT_NE(builder_->FindBuilt({.traverse = kept}, 7), nullptr) << kept;
  }
}

TEST_F(MapBuilderTest, AMapLargerThanAllMayBeIsRefused) {
  builder_ = Open({.max_stored_bytes = 10000});
  EXPECT_THAT(builder_->Build({.traverse = kTraverse}, source_, {}), HasReason(v1::ERROR_REASON_STORAGE_FULL));
  EXPECT_THAT(Files(), IsEmpty());
  EXPECT_THAT(builder_->Build({.traverse = kTraverse, .cell_m = 5.0}, source_, {}), IsOk());
}

TEST_F(MapBuilderTest, DamagedAndUnfinishedFilesAreBuiltAnew) {
  const std::string payload = PayloadOf(*Build({.traverse = kTraverse}));
  const std::string path = Files().front();
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 1);
  EXPECT_EQ(builder_->FindBuilt({.traverse = kTraverse}, 7), nullptr);
  EXPECT_TRUE(PayloadOf(*Build({.traverse = kTraverse})) == payload);
  std::ofstream(path, std::ios::trunc) << "short";
  EXPECT_TRUE(PayloadOf(*Build({.traverse = kTraverse})) == payload);
  std::ofstream(path + ".part") << "killed meanwhile";
  builder_ = Open({});
  EXPECT_THAT(Files(), SizeIs(1));
}

TEST_F(MapBuilderTest, CanBeBuiltAfterALibraryThrew) {
  ThrowingStore store(*store_);
  MapEnvironment environment;
  environment.store = &store;
  environment.memory = &memory_;
  const auto builder = MapBuilder::Open(folder_.path(), environment, {});
  ASSERT_THAT(builder, IsOk());
  for (int i = 0; i < 2; ++i) {  // the second would wait for the first for ever
    EXPECT_THROW((*builder)->Build({.traverse = kTraverse}, source_, {}).IgnoreError(), std::bad_alloc);
  }
  EXPECT_EQ(memory_.reserved_bytes(), 0U);
}

TEST_F(MapBuilderTest, RequestsAreChecked) {
  for (const double cell_m : {0.009, 10.1, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THAT(builder_->Build({.traverse = kTraverse, .cell_m = cell_m}, source_, {}),
                HasReason(v1::ERROR_REASON_INVALID_FIELD));
  }
  EXPECT_THAT(builder_->Build({.traverse = kTraverse, .kind = static_cast<v1::MapKind>(77)}, source_, {}),
              HasReason(v1::ERROR_REASON_INVALID_FIELD));
  EXPECT_THAT(Files(), IsEmpty());
}

TEST_F(MapBuilderTest, MemoryIsReserved) {
  {
    const auto others = memory_.Reserve(memory_.total_bytes() - 1000);
    ASSERT_THAT(others, IsOk());
    EXPECT_THAT(builder_->Build({.traverse = kTraverse}, source_, {}), HasReason(v1::ERROR_REASON_MEMORY_BUDGET));
    EXPECT_THAT(Files(), IsEmpty());
  }
  EXPECT_THAT(builder_->Build({.traverse = kTraverse}, source_, {}), IsOk());
  // Two points far apart: a grid of 10^10 cells.
  Scan far = *scene_.scans[0];
  far.points.emplace_back(9000.0F, 9000.0F, 0.0F);
  source_.scan_ids[0] = Add(far);
  EXPECT_THAT(builder_->Build({.traverse = kTraverse, .kind = v1::MAP_KIND_ELEVATION_ASCII}, source_, {}),
              HasReason(v1::ERROR_REASON_SCAN_TOO_LARGE));
}

TEST_F(MapBuilderTest, NoScansGiveAnEmptyMap) {
  source_ = {};
  const auto points = Build({.traverse = kTraverse});
  EXPECT_EQ(points->header().payload_bytes(), 0U);
  EXPECT_EQ(points->header().cell_count(), 0U);
  EXPECT_EQ(Build({.traverse = kTraverse, .kind = v1::MAP_KIND_ELEVATION_ASCII})->header().cell_count(), 0U);
}

TEST_F(MapBuilderTest, StopsWhenAsked) {
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THAT(builder_->Build({.traverse = kTraverse}, source_, {.cancellation = stop.get_token(), .deadline = {}}),
              HasCode(absl::StatusCode::kCancelled));
  EXPECT_THAT(builder_->Build({.traverse = kTraverse}, source_,
                              {.cancellation = {}, .deadline = std::chrono::steady_clock::now()}),
              HasCode(absl::StatusCode::kDeadlineExceeded));
  EXPECT_THAT(Files(), IsEmpty());
}

TEST_F(MapBuilderTest, CallsForTheSameMapAtOnceGetTheSame) {
  std::vector<std::string> payloads(4);
  std::vector<std::thread> threads;
  for (std::string& payload : payloads) {
    threads.emplace_back([&] { payload = PayloadOf(*Build({.traverse = kTraverse, .cell_m = 0.05})); });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::string& payload : payloads) EXPECT_TRUE(payload == payloads[0]);
  EXPECT_FALSE(payloads[0].empty());
  EXPECT_THAT(Files(), SizeIs(1));
}

}  // namespace
}  // namespace curvereg::server
