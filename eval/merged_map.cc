// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/merged_map.h"

#include <cassert>
#include <optional>

#include "eval/cell_key.h"

namespace curvereg {
MergedMap::MergedMap(double cell_size_m) : cell_size_m_(cell_size_m) { assert(cell_size_m > 0.0); }

void MergedMap::Add(const Scan& scan, const RigidTransform& T_world_scan) {
  for (const Eigen::Vector3f& point : scan.points) {
    if (!point.allFinite()) continue;
    const Eigen::Vector3d point_world = T_world_scan * point.cast<double>();
    const std::optional<GridCell> cell = CellOf(point_world, cell_size_m_);
    if (!cell) continue;
    const auto [entry, is_new] = index_of_.try_emplace(cell->key, cells_.size());
    if (is_new) cells_.emplace_back();
    cells_[entry->second].sum += point_world;
    ++cells_[entry->second].count;
  }
}

Scan MergedMap::Points() const {
  Scan map;
  map.points.reserve(cells_.size());
  for (const Cell& cell : cells_) map.points.push_back((cell.sum / static_cast<double>(cell.count)).cast<float>());
  return map;
}

}  // namespace curvereg
