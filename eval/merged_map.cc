// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/merged_map.h"

#include <cassert>

namespace curvereg {
namespace {

constexpr double kMaxCell = 1 << 20;  // 21 bits and a sign fit three to a 64-bit key

uint64_t Key(const Eigen::Vector3d& cell) {
  uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) key = (key << 21) | static_cast<uint64_t>(cell[axis] + kMaxCell);
  return key;
}

}  // namespace

MergedMap::MergedMap(double cell_size_m) : cell_size_m_(cell_size_m) { assert(cell_size_m > 0.0); }

void MergedMap::Add(const Scan& scan, const RigidTransform& T_world_scan) {
  for (const Eigen::Vector3f& point : scan.points) {
    if (!point.allFinite()) continue;
    const Eigen::Vector3d point_world = T_world_scan * point.cast<double>();
    const Eigen::Vector3d cell = (point_world / cell_size_m_).array().floor();
    if (cell.cwiseAbs().maxCoeff() >= kMaxCell) continue;
    const auto [entry, is_new] = index_of_.try_emplace(Key(cell), cells_.size());
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
