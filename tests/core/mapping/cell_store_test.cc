// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/cell_store.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <random>

namespace curvereg {
namespace {

PlacedPoint At(uint64_t key, float offset) { return {key, Eigen::Vector3f::Constant(offset)}; }

TEST(CellStoreTest, SumsPointsByKey) {
  CellStore store(1000);
  store.Begin(0, CellGrid::kEndKey);
  store.Add(At(7, 0.25F));
  store.Add(At(3, 0.5F));
  store.Add(At(7, -0.5F));
  const std::vector<CellSum>& cells = store.Sort();
  ASSERT_EQ(cells.size(), 2U);
  EXPECT_EQ(cells[0].key, 3U);
  EXPECT_EQ(cells[0].count, 1U);
  EXPECT_EQ(cells[1].key, 7U);
  EXPECT_EQ(cells[1].count, 2U);
  EXPECT_EQ(cells[1].offset_sum, Eigen::Vector3f::Constant(-0.25F));
  store.Begin(0, CellGrid::kEndKey);
  EXPECT_TRUE(store.Sort().empty());
}

TEST(CellStoreTest, TakesItsRunAlone) {
  CellStore store(10);
  store.Begin(5, 8);
  for (uint64_t key = 0; key < 20; ++key) store.Add(At(key, 0.0F));
  ASSERT_EQ(store.Sort().size(), 3U);
  EXPECT_EQ(store.end_key(), 8U);
}

// All runs of a store that holds `max_cells`, one after the other.
std::vector<CellSum> AllRuns(const std::vector<PlacedPoint>& points, std::size_t max_cells, int* num_runs) {
  std::vector<CellSum> all;
  CellStore store(max_cells);
  *num_runs = 0;
  for (uint64_t begin = 0; begin < CellGrid::kEndKey; begin = store.end_key()) {
    store.Begin(begin, CellGrid::kEndKey);
    for (const PlacedPoint& point : points) store.Add(point);
    const std::vector<CellSum>& cells = store.Sort();
    EXPECT_LE(cells.size(), max_cells);
    EXPECT_GT(store.end_key(), begin);
    all.insert(all.end(), cells.begin(), cells.end());
    ++*num_runs;
  }
  return all;
}

TEST(CellStoreTest, RunsThatAreCutGiveTheSameCells) {
  std::mt19937_64 generator(4);
  std::vector<PlacedPoint> points;
  for (int i = 0; i < 20000; ++i) {
    points.push_back(At((generator() % 3000) * 0x1234567890ab % CellGrid::kEndKey,
                        static_cast<float>(generator() % 1000) / 1000.0F - 0.5F));
  }
  int num_runs = 0;
  const std::vector<CellSum> at_once = AllRuns(points, 100000, &num_runs);
  EXPECT_EQ(num_runs, 1);
  EXPECT_GT(at_once.size(), 2900U);
  for (const std::size_t max_cells : {1999U, 100U, 2U}) {
    if (max_cells == 2U) points.resize(300);  // a run for each cell or two
    const std::vector<CellSum> whole = AllRuns(points, 100000, &num_runs);
    const std::vector<CellSum> cut = AllRuns(points, max_cells, &num_runs);
    EXPECT_GT(num_runs, 1);
    ASSERT_EQ(cut.size(), whole.size());
    for (std::size_t i = 0; i < cut.size(); ++i) {
      EXPECT_EQ(cut[i].key, whole[i].key);
      EXPECT_EQ(cut[i].count, whole[i].count);
      EXPECT_EQ(cut[i].offset_sum, whole[i].offset_sum);
    }
  }
}

}  // namespace
}  // namespace curvereg
