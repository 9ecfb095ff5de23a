// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/methods/prepared_scan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "tests/testing/matchers.h"
#include "tests/testing/same_bytes.h"
#include "tests/testing/scenes.h"

namespace curvereg {
namespace {

using testing::IsOk;

// Precondition: the scan is valid.
std::unique_ptr<const PreparedScan> Prepared(std::shared_ptr<const Scan> scan, const PreparationOptions& options = {}) {
  return *PreparedScan::Create(std::move(scan), options);
}

std::shared_ptr<const Scan> GroundScan() {
  return std::make_shared<Scan>(testing::BumpyGround(testing::RoverPose(0.0, 0.0, 0.4), {.num_columns = 360}));
}

TEST(PreparedScanTest, HoldsWhatTheStagesComputeOneByOne) {
  const auto scan = GroundScan();
  const PreparationOptions options;
  const auto prepared = Prepared(scan, options);
  EXPECT_EQ(&prepared->scan(), scan.get());
  const auto maps = BuildVoxelMaps(scan->points, options.voxels);
  ASSERT_EQ(prepared->voxel_maps().size(), maps.size());
  for (size_t level = 0; level < maps.size(); ++level) {
    EXPECT_EQ(prepared->voxel_maps()[level].surfels().size(), maps[level].surfels().size());
  }
  const auto verticals = FindVerticals(maps, scan->gravity, options.leveling);
  ASSERT_EQ(prepared->verticals().size(), verticals.size());
  EXPECT_EQ(prepared->verticals()[0].R_level_sensor, verticals[0].R_level_sensor);
  const auto view = prepared->View(BirdsEyeView::kElevation, 0);
  ASSERT_THAT(view, IsOk());
  const auto expected = ComputeViewFeatures(scan->points, verticals[0].R_level_sensor, options.elevation);
  EXPECT_EQ((*view)->features.descriptors, expected->features.descriptors);
}

TEST(PreparedScanTest, DownsampledPointsAreMeasuredOnesOnePerFinestCell) {
  const auto scan = GroundScan();
  const auto prepared = Prepared(scan);
  const VoxelMap& finest = prepared->voxel_maps().front();
  ASSERT_EQ(prepared->downsampled_points().size(), finest.surfels().size());
  std::vector<bool> seen(finest.surfels().size(), false);
  for (const Eigen::Vector3f& point : prepared->downsampled_points()) {
    EXPECT_NE(std::find(scan->points.begin(), scan->points.end(), point), scan->points.end());
    const int cell = finest.Find(point);
    ASSERT_GE(cell, 0);
    EXPECT_FALSE(seen[static_cast<size_t>(cell)]);
    seen[static_cast<size_t>(cell)] = true;
  }
}

TEST(PreparedScanTest, GravityGivesTheOnlyVertical) {
  Scan scan = *GroundScan();
  scan.gravity = Eigen::Vector3d(0.1, 0.0, -1.0);
  const auto prepared = Prepared(std::make_shared<Scan>(scan));
  ASSERT_EQ(prepared->verticals().size(), 1U);
  const Eigen::Vector3d up = prepared->verticals()[0].R_level_sensor * -*scan.gravity;
  EXPECT_LT(up.head<2>().norm(), 1e-9);
}

TEST(PreparedScanTest, EveryViewOfEveryVerticalIsLevelledByIt) {
  testing::ScannerOptions scanner;
  scanner.num_columns = 360;
  scanner.min_elevation_rad = -1.3;
  scanner.max_elevation_rad = 1.3;
  PreparationOptions options;
  options.leveling.min_relative_weight = 0.05;
  const auto scan = std::make_shared<Scan>(testing::FurnishedHall(testing::UprightPose(0.5, 0.2, 0.3), scanner));
  const auto prepared = Prepared(scan, options);
  ASSERT_EQ(prepared->verticals().size(), 2U);
  for (size_t vertical = 0; vertical < 2; ++vertical) {
    for (const BirdsEyeView kind : {BirdsEyeView::kElevation, BirdsEyeView::kOccupancy}) {
      const auto view = prepared->View(kind, vertical);
      ASSERT_THAT(view, IsOk());
      EXPECT_EQ((*view)->R_level_sensor, prepared->verticals()[vertical].R_level_sensor);
      EXPECT_EQ((*view)->slices.slices.empty(), kind == BirdsEyeView::kElevation);
    }
  }
}

TEST(PreparedScanTest, ViewsAreComputedOnceWhoeverAsks) {
  const auto prepared = Prepared(GroundScan());
  std::vector<const ViewFeatures*> views(4);
  std::vector<std::thread> threads;
  for (const ViewFeatures*& view : views) {
    threads.emplace_back([&] { view = *prepared->View(BirdsEyeView::kOccupancy, 0); });
  }
  for (std::thread& thread : threads) thread.join();
  for (const ViewFeatures* view : views) EXPECT_EQ(view, views[0]);
  EXPECT_EQ(*prepared->View(BirdsEyeView::kOccupancy, 0), views[0]);
}

TEST(PreparedScanTest, BadViewOptionsAreAnErrorOfTheView) {
  PreparationOptions options;
  options.elevation.bands.num_scales = 20;
  const auto prepared = Prepared(GroundScan(), options);
  EXPECT_THAT(prepared->View(BirdsEyeView::kElevation, 0), testing::HasCode(absl::StatusCode::kInvalidArgument));
  EXPECT_THAT(prepared->View(BirdsEyeView::kOccupancy, 0), IsOk());
}

TEST(PreparedScanTest, WithoutOutliersLacksFalseReturns) {
  Scan scan = *GroundScan();
  const size_t num_ground = scan.points.size();
  for (int i = 0; i < 50; ++i) {  // scattered above the ground
    const auto angle = 0.125F * static_cast<float>(i);
    scan.points.emplace_back(3.0F * std::cos(angle), 3.0F * std::sin(angle), -0.4F);
  }
  const auto prepared = Prepared(std::make_shared<Scan>(scan));
  const auto filtered = prepared->WithoutOutliers();
  ASSERT_THAT(filtered, IsOk());
  EXPECT_LT((*filtered)->scan().points.size(), num_ground);
  EXPECT_GT((*filtered)->scan().points.size(), num_ground * 8 / 10);
  EXPECT_THAT((*filtered)->View(BirdsEyeView::kElevation, 0), IsOk());
  EXPECT_EQ(*prepared->WithoutOutliers(), *filtered);  // computed once
}

TEST(PreparedScanTest, MemoryGrowsWithWhatIsComputed) {
  const auto scan = GroundScan();
  const auto prepared = Prepared(scan);
  const size_t first = prepared->MemoryBytes();
  size_t parts = scan->points.size() * sizeof(Eigen::Vector3f);
  for (const VoxelMap& map : prepared->voxel_maps()) parts += map.surfels().size() * sizeof(Surfel);
  EXPECT_GE(first, parts);
  EXPECT_LE(first, 3 * parts);
  EXPECT_EQ(prepared->MemoryBytes(), first);  // asking changes nothing

  const auto view = prepared->View(BirdsEyeView::kElevation, 0);
  ASSERT_THAT(view, IsOk());
  const size_t with_view = prepared->MemoryBytes();
  const Features& features = (*view)->features;
  const size_t pixels = (*view)->image.values.size();
  EXPECT_GE(with_view - first, sizeof(float) * (features.descriptors.size() + 2 * pixels) + 2 * pixels);
  ASSERT_THAT(prepared->View(BirdsEyeView::kElevation, 0), IsOk());
  EXPECT_EQ(prepared->MemoryBytes(), with_view);  // computed once

  const auto filtered = prepared->WithoutOutliers();
  ASSERT_THAT(filtered, IsOk());
  EXPECT_EQ(prepared->MemoryBytes(), with_view + (*filtered)->MemoryBytes());
  ASSERT_THAT((*filtered)->View(BirdsEyeView::kOccupancy, 0), IsOk());
  EXPECT_EQ(prepared->MemoryBytes(), with_view + (*filtered)->MemoryBytes());
}

TEST(PreparedScanTest, MemoryMayBeAskedForWhileOthersCompute) {
  const auto prepared = Prepared(GroundScan());
  std::vector<std::thread> threads;
  threads.emplace_back([&] { EXPECT_THAT(prepared->View(BirdsEyeView::kOccupancy, 0), IsOk()); });
  threads.emplace_back([&] { EXPECT_THAT(prepared->WithoutOutliers(), IsOk()); });
  size_t last = 0;
  for (int i = 0; i < 1000; ++i) {
    const size_t bytes = prepared->MemoryBytes();
    EXPECT_GE(bytes, last);
    last = bytes;
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_GT(prepared->MemoryBytes(), prepared->scan().points.size() * sizeof(Eigen::Vector3f));
}

TEST(PreparedScanTest, RefusesScansThatAreNotValid) {
  EXPECT_THAT(PreparedScan::Create(std::make_shared<Scan>()), testing::HasCode(absl::StatusCode::kInvalidArgument));
  PreparationOptions options;
  options.limits.max_points = 1000;
  EXPECT_THAT(PreparedScan::Create(GroundScan(), options), testing::HasCode(absl::StatusCode::kInvalidArgument));
}

TEST(PreparedScanTest, StopsWhenAsked) {
  std::stop_source source;
  Stop stop;
  stop.cancellation = source.get_token();
  const auto prepared = PreparedScan::Create(GroundScan(), {}, stop);
  ASSERT_THAT(prepared, IsOk());
  source.request_stop();
  EXPECT_THAT(PreparedScan::Create(GroundScan(), {}, stop), testing::HasCode(absl::StatusCode::kCancelled));
  EXPECT_THAT((*prepared)->WithoutOutliers(stop), testing::HasCode(absl::StatusCode::kCancelled));
  EXPECT_THAT((*prepared)->WithoutOutliers(), IsOk());  // what was stopped is not kept
  Stop late;
  late.deadline = std::chrono::steady_clock::now();
  EXPECT_THAT(PreparedScan::Create(GroundScan(), {}, late), testing::HasCode(absl::StatusCode::kDeadlineExceeded));
}

TEST(PreparedScanTest, SameBytesAtAnyThreadCount) {
  const auto scan = GroundScan();
  testing::ExpectSameBytesAtAnyThreadCount([&](testing::ByteLog& log) {
    const auto prepared = Prepared(scan);
    for (const Eigen::Vector3f& point : prepared->downsampled_points()) log.Add(point.data(), 3);
    for (const LevelingCandidate& candidate : prepared->verticals()) log.Add(candidate.R_level_sensor.data(), 9);
    log.Add((*prepared->View(BirdsEyeView::kElevation, 0))->features.descriptors);
  });
}

}  // namespace
}  // namespace curvereg
