// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/prepared_scan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

#include "tests/testing/matchers.h"
#include "tests/testing/same_bytes.h"
#include "tests/testing/scenes.h"

namespace curvereg {
namespace {

using testing::IsOk;

std::shared_ptr<const Scan> GroundScan() {
  return std::make_shared<Scan>(testing::BumpyGround(testing::RoverPose(0.0, 0.0, 0.4), {.num_columns = 360}));
}

TEST(PreparedScanTest, HoldsWhatTheStagesComputeOneByOne) {
  const auto scan = GroundScan();
  const PreparationOptions options;
  const PreparedScan prepared(scan, options);
  EXPECT_EQ(&prepared.scan(), scan.get());
  const auto maps = BuildVoxelMaps(scan->points, options.voxels);
  ASSERT_EQ(prepared.voxel_maps().size(), maps.size());
  for (size_t level = 0; level < maps.size(); ++level) {
    EXPECT_EQ(prepared.voxel_maps()[level].surfels().size(), maps[level].surfels().size());
  }
  const auto verticals = FindVerticals(maps, scan->gravity, options.leveling);
  ASSERT_EQ(prepared.verticals().size(), verticals.size());
  EXPECT_EQ(prepared.verticals()[0].R_level_sensor, verticals[0].R_level_sensor);
  const auto view = prepared.View(BirdsEyeView::kElevation, 0);
  ASSERT_THAT(view, IsOk());
  const auto expected = ComputeViewFeatures(scan->points, verticals[0].R_level_sensor, options.elevation);
  EXPECT_EQ((*view)->features.descriptors, expected->features.descriptors);
}

TEST(PreparedScanTest, RepresentativesAreMeasuredPointsOnePerFinestCell) {
  const auto scan = GroundScan();
  const PreparedScan prepared(scan, {});
  const VoxelMap& finest = prepared.voxel_maps().front();
  ASSERT_EQ(prepared.representatives().size(), finest.surfels().size());
  std::vector<bool> seen(finest.surfels().size(), false);
  for (const Eigen::Vector3f& point : prepared.representatives()) {
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
  const PreparedScan prepared(std::make_shared<Scan>(scan), {});
  ASSERT_EQ(prepared.verticals().size(), 1U);
  const Eigen::Vector3d up = prepared.verticals()[0].R_level_sensor * -*scan.gravity;
  EXPECT_LT(up.head<2>().norm(), 1e-9);
}

TEST(PreparedScanTest, EveryViewOfEveryVerticalIsLevelledByIt) {
  testing::ScannerOptions scanner;
  scanner.num_columns = 360;
  scanner.min_elevation_rad = -1.3;
  scanner.max_elevation_rad = 1.3;
  PreparationOptions options;
  options.leveling.min_relative_weight = 0.05;
  const auto scan = std::make_shared<Scan>(testing::FurnishedHall(testing::SensorPose(0.5, 0.2, 0.3), scanner));
  const PreparedScan prepared(scan, options);
  ASSERT_EQ(prepared.verticals().size(), 2U);
  for (size_t vertical = 0; vertical < 2; ++vertical) {
    for (const BirdsEyeView kind : {BirdsEyeView::kElevation, BirdsEyeView::kOccupancy}) {
      const auto view = prepared.View(kind, vertical);
      ASSERT_THAT(view, IsOk());
      EXPECT_EQ((*view)->R_level_sensor, prepared.verticals()[vertical].R_level_sensor);
      EXPECT_EQ((*view)->slices.slices.empty(), kind == BirdsEyeView::kElevation);
    }
  }
}

TEST(PreparedScanTest, ViewsAreComputedOnceWhoeverAsks) {
  const PreparedScan prepared(GroundScan(), {});
  std::vector<const ViewFeatures*> views(4);
  std::vector<std::thread> threads;
  for (const ViewFeatures*& view : views) {
    threads.emplace_back([&] { view = *prepared.View(BirdsEyeView::kOccupancy, 0); });
  }
  for (std::thread& thread : threads) thread.join();
  for (const ViewFeatures* view : views) EXPECT_EQ(view, views[0]);
  EXPECT_EQ(*prepared.View(BirdsEyeView::kOccupancy, 0), views[0]);
}

TEST(PreparedScanTest, BadViewOptionsAreAnErrorOfTheView) {
  PreparationOptions options;
  options.elevation.bands.num_scales = 20;
  const PreparedScan prepared(GroundScan(), options);
  EXPECT_THAT(prepared.View(BirdsEyeView::kElevation, 0), testing::HasCode(absl::StatusCode::kInvalidArgument));
  EXPECT_THAT(prepared.View(BirdsEyeView::kOccupancy, 0), IsOk());
}

TEST(PreparedScanTest, SameBytesAtAnyThreadCount) {
  const auto scan = GroundScan();
  testing::ExpectSameBytesAtAnyThreadCount([&](testing::ByteLog& log) {
    const PreparedScan prepared(scan, {});
    for (const Eigen::Vector3f& point : prepared.representatives()) log.Add(point.data(), 3);
    for (const LevelingCandidate& candidate : prepared.verticals()) log.Add(candidate.R_level_sensor.data(), 9);
    log.Add((*prepared.View(BirdsEyeView::kElevation, 0))->features.descriptors);
  });
}

}  // namespace
}  // namespace curvereg
