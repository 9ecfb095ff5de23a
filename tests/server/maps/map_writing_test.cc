// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/maps/map_writing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "core/mapping/elevation_map.h"
#include "core/mapping/point_map.h"
#include "tests/core/mapping/map_scenes.h"
#include "tests/server/store/store_testing.h"
#include "wire/point_codec.h"

namespace curvereg::server {
namespace {

using testing::HasCode;
using testing::IsOk;
using testing::MapScene;

// A few stored scans of a strip.
class MapWritingTest : public ::testing::Test {
 protected:
  MapWritingTest() {
    for (const auto& scan : scene_.scans) {
      const v1::PointCloud cloud = *wire::EncodeScan(*scan);
      const std::string& payload = cloud.data();
      const auto stored = Store(*store_, {"upload", cloud.header(), payload.size(), DigestOf(payload)}, payload);
      EXPECT_THAT(stored, IsOk());
      if (stored.ok()) source_.scan_ids.push_back(stored->scan.id);
    }
    source_.T_segment_scan = scene_.T_map_scan;
  }

  absl::StatusOr<uint64_t> Write(const MapContents& contents, const Stop& stop = {}) {
    bytes_.clear();
    const MapSink sink = [this](std::string_view bytes) {
      bytes_ += bytes;
      return absl::OkStatus();
    };
    return WriteMap(contents, source_, environment_, sink, stop);
  }

  testing::TemporaryFolder folder_;
  std::unique_ptr<ScanStore> store_ = OpenStore(folder_.path());
  MemoryBudget memory_{uint64_t{256} << 20};
  MapEnvironment environment_ = {.limits = {}, .store = store_.get(), .memory = &memory_};
  const MapScene scene_ = testing::Strip(3, 2000);
  MapSource source_;
  std::string bytes_;
};

TEST_F(MapWritingTest, PointsArePackedCoordinates) {
  const auto num_points = Write({.kind = v1::MAP_KIND_POINTS, .cell_m = 0.2});
  ASSERT_THAT(num_points, IsOk());
  const std::vector<Eigen::Vector3f> expected = testing::PointsOf(scene_, {.cell_m = 0.2});
  ASSERT_GT(expected.size(), 500U);
  EXPECT_EQ(*num_points, expected.size());
  ASSERT_EQ(bytes_.size(), 12 * expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    Eigen::Vector3f point;
    std::memcpy(point.data(), bytes_.data() + 12 * i, 12);
    ASSERT_EQ(point, expected[i]);
  }
  EXPECT_EQ(memory_.reserved_bytes(), 0U);
}

TEST_F(MapWritingTest, ElevationIsTheGridOfTheCore) {
  const auto num_cells = Write({.kind = v1::MAP_KIND_ELEVATION_ASCII, .cell_m = 0.5});
  ASSERT_THAT(num_cells, IsOk());
  const auto expected = BuildElevationMap(scene_.Input(), {.cell_m = 0.5});
  ASSERT_THAT(expected, IsOk());
  EXPECT_EQ(*num_cells, static_cast<uint64_t>(expected->num_columns) * static_cast<uint64_t>(expected->num_rows));
  std::string text;
  ASSERT_THAT(WriteEsriAscii(*expected,
                             [&](std::string_view piece) {
                               text += piece;
                               return absl::OkStatus();
                             }),
              IsOk());
  EXPECT_TRUE(bytes_ == text);
}

TEST_F(MapWritingTest, AnErrorOfTheSinkEndsIt) {
  int num_pieces = 0;
  const MapSink full = [&](std::string_view) {
    ++num_pieces;
    return absl::DataLossError("the disk is gone");
  };
  EXPECT_THAT(WriteMap({}, source_, environment_, full, {}), HasCode(absl::StatusCode::kDataLoss));
  EXPECT_EQ(num_pieces, 1);
  EXPECT_EQ(memory_.reserved_bytes(), 0U);
}

TEST_F(MapWritingTest, MemoryIsReservedBeforeAnythingIsWritten) {
  const auto others = memory_.Reserve(memory_.total_bytes() - 1000);
  ASSERT_THAT(others, IsOk());
  EXPECT_THAT(Write({}), HasReason(v1::ERROR_REASON_MEMORY_BUDGET));
  EXPECT_TRUE(bytes_.empty());
}

TEST_F(MapWritingTest, AllScansAreLookedUpBeforeAnythingIsWritten) {
  ASSERT_THAT(store_->DeleteScan(source_.scan_ids.back()), IsOk());
  EXPECT_THAT(Write({}), HasReason(v1::ERROR_REASON_SCAN_NOT_FOUND));
  EXPECT_TRUE(bytes_.empty());
}

TEST_F(MapWritingTest, NarrowerLimitsHoldForStoredScansToo) {
  environment_.limits.max_scan_points = 10;
  EXPECT_THAT(Write({}), HasReason(v1::ERROR_REASON_SCAN_TOO_LARGE));
  EXPECT_TRUE(bytes_.empty());
}

TEST_F(MapWritingTest, AGridThatIsTooLargeIsRefused) {
  source_.T_segment_scan.back().translation() += Eigen::Vector3d(1e5, 1e5, 0.0);
  EXPECT_THAT(Write({.kind = v1::MAP_KIND_ELEVATION_ASCII, .cell_m = 0.1}), HasReason(v1::ERROR_REASON_SCAN_TOO_LARGE));
}

TEST_F(MapWritingTest, NoScansGiveNoPoints) {
  source_ = {};
  EXPECT_EQ(*Write({.kind = v1::MAP_KIND_POINTS}), 0U);
  EXPECT_TRUE(bytes_.empty());
  EXPECT_EQ(*Write({.kind = v1::MAP_KIND_ELEVATION_ASCII}), 0U);
}

TEST_F(MapWritingTest, StopsWhenAsked) {
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THAT(Write({}, {stop.get_token(), {}}), HasCode(absl::StatusCode::kCancelled));
  EXPECT_TRUE(bytes_.empty());
}

}  // namespace
}  // namespace curvereg::server
