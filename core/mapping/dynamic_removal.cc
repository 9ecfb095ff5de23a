// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/dynamic_removal.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/parallel.h"

namespace curvereg {
namespace {

// Tiles of 16 cells per edge: few to look over, small beside the reach of a scan.
constexpr int kTileLevel = 4;

void CountUp(uint16_t& votes) {
  if (votes < std::numeric_limits<uint16_t>::max()) ++votes;
}

}  // namespace

FreeSpaceVotes::FreeSpaceVotes(const std::vector<CellSum>& cells, const CellGrid& grid,
                               const DynamicRemovalOptions& options)
    : cells_(cells), grid_(grid), options_(options), votes_(cells.size()) {
  options_.free_space.margin_m += 0.5 * grid.cell_m();
  tile_radius_m_ = 0.5 * std::sqrt(3.0) * grid.cell_m() * (1 << kTileLevel);
  constexpr int kShift = 3 * kTileLevel;
  for (std::size_t begin = 0; begin < cells.size();) {
    std::size_t end = begin + 1;
    while (end < cells.size() && cells[end].key >> kShift == cells[begin].key >> kShift) ++end;
    tiles_.push_back({begin, end, grid.Centre(cells[begin].key, kTileLevel)});
    begin = end;
  }
}

bool FreeSpaceVotes::IsNear(const Eigen::Vector3d& position, const Tile& tile) const {
  return (tile.centre - position).norm() < options_.max_range_m + tile_radius_m_;
}

bool FreeSpaceVotes::HasVote(const RigidTransform& T_map_scan) const {
  return std::any_of(tiles_.begin(), tiles_.end(),
                     [&](const Tile& tile) { return IsNear(T_map_scan.translation(), tile); });
}

void FreeSpaceVotes::AddScan(const Scan& scan, const RigidTransform& T_map_scan, const Stop& stop) {
  const FreeSpace free_space(scan.points, options_.free_space, stop);
  const RigidTransform T_scan_map = T_map_scan.inverse();
  std::vector<const Tile*> near;
  for (const Tile& tile : tiles_) {
    if (IsNear(T_map_scan.translation(), tile)) near.push_back(&tile);
  }
  constexpr int kTilesPerTask = 16;
  const int num_near = static_cast<int>(near.size());
  ParallelFor((num_near + kTilesPerTask - 1) / kTilesPerTask, [&](int task) {
    for (int i = task * kTilesPerTask; i < std::min(num_near, (task + 1) * kTilesPerTask); ++i) {
      if (stop.Requested()) return;
      Vote(free_space, T_scan_map, *near[static_cast<std::size_t>(i)]);
    }
  });
}

void FreeSpaceVotes::Vote(const FreeSpace& free_space, const RigidTransform& T_scan_map, const Tile& tile) {
  const auto max_range_m = static_cast<float>(options_.max_range_m);
  for (std::size_t i = tile.begin; i < tile.end; ++i) {
    const Eigen::Vector3f point = (T_scan_map * MeanOf(cells_[i], grid_)).cast<float>();
    if (point.squaredNorm() > max_range_m * max_range_m) continue;
    switch (free_space.Ask(point)) {
      case FreeSpace::Answer::kViolates:
        CountUp(votes_[i].through);
        break;
      case FreeSpace::Answer::kAgrees:
        CountUp(votes_[i].surface);
        break;
      case FreeSpace::Answer::kUnseen:
        break;
    }
  }
}

}  // namespace curvereg
