// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/tile_index.h"

#include <gtest/gtest.h>

#include "core/mapping/cell_grid.h"

namespace curvereg {
namespace {

// Tiles of 64 cells: keys 64 t to 64 t + 63.
constexpr int kLevel = 2;

TEST(TileIndexTest, KnowsWhichScansTouchARun) {
  TileIndex index(3, kLevel);
  for (const uint64_t key : {130U, 64U, 191U, 65U}) index.AddPoint(key);  // tiles 1 and 2
  index.EndScan(0);
  index.EndScan(1);  // nothing
  index.AddPoint(640);
  index.EndScan(2);
  EXPECT_TRUE(index.Touches(0, 0, CellGrid::kEndKey));
  EXPECT_TRUE(index.Touches(0, 150, 160)) << "part of a tile";
  EXPECT_TRUE(index.Touches(0, 0, 65));
  EXPECT_FALSE(index.Touches(0, 0, 64));
  EXPECT_FALSE(index.Touches(0, 192, CellGrid::kEndKey));
  EXPECT_FALSE(index.Touches(1, 0, CellGrid::kEndKey));
  EXPECT_TRUE(index.Touches(2, 192, CellGrid::kEndKey));
}

TEST(TileIndexTest, CountsAndCutsRunsByTiles) {
  TileIndex index(2, kLevel);
  for (uint64_t tile = 0; tile < 10; ++tile) index.AddPoint(64 * tile + 5);
  index.EndScan(0);
  for (uint64_t tile = 5; tile < 20; ++tile) index.AddPoint(64 * tile);
  index.EndScan(1);
  EXPECT_EQ(index.CountTiles(0, CellGrid::kEndKey), 20U);
  EXPECT_EQ(index.CountTiles(64, 128), 1U);
  EXPECT_EQ(index.CountTiles(100, 129), 2U);
  EXPECT_EQ(index.EndOfRun(0, 7, CellGrid::kEndKey), 7U * 64U);
  EXPECT_EQ(index.EndOfRun(100, 1, CellGrid::kEndKey), 128U) << "the rest of a tile";
  EXPECT_EQ(index.EndOfRun(100, 0, CellGrid::kEndKey), 128U) << "at least one";
  EXPECT_EQ(index.EndOfRun(64, 19, CellGrid::kEndKey), CellGrid::kEndKey);
  EXPECT_EQ(index.EndOfRun(0, 7, 100), 100U);
}

TEST(TileIndexTest, ScansStrewnFarAndWideTouchEverything) {
  TileIndex index(2, kLevel);
  const auto num_tiles = uint64_t{5} * TileIndex::kMaxTilesPerScan;
  for (uint64_t tile = 0; tile < num_tiles; ++tile) index.AddPoint(64 * (2 * tile));
  index.EndScan(0);
  index.AddPoint(64 * 7);
  index.EndScan(1);
  EXPECT_TRUE(index.Touches(0, 64 * 3, 64 * 4)) << "it may";
  EXPECT_FALSE(index.Touches(1, 64 * 3, 64 * 4));
  // As many points in few tiles are no such scan.
  TileIndex few(1, kLevel);
  for (uint64_t i = 0; i < num_tiles; ++i) few.AddPoint(64 * (i % 100));
  few.EndScan(0);
  EXPECT_FALSE(few.Touches(0, 64 * 100, CellGrid::kEndKey));
}

}  // namespace
}  // namespace curvereg
