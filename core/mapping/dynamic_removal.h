// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Dynamic-object removal by free-space (visibility) voting: cells of a map that hold what moved, or false returns.
// Every scan near enough votes on every cell: its beams passed through it, or ended in it (core/scan/free_space.h). One
// scan's free space is held at a time. Comparing the map with range images of single scans is the method of [Kim 2020];
// here all scans vote, and a cell is removed by majority.
#ifndef CURVEREG_CORE_MAPPING_DYNAMIC_REMOVAL_H_
#define CURVEREG_CORE_MAPPING_DYNAMIC_REMOVAL_H_

#include <cstdint>
#include <vector>

#include "core/base/rigid_transform.h"
#include "core/base/stop.h"
#include "core/mapping/cell_grid.h"
#include "core/mapping/cell_store.h"
#include "core/scan/free_space.h"
#include "core/scan/scan.h"

namespace curvereg {

struct DynamicRemovalOptions {
  double max_range_m = 30.0;  // farther off, directions are too coarse for small things
  // Finer than for verdicts: poses of a map are good to centimetres. Half a cell is added to margin_m.
  FreeSpaceOptions free_space = {
      .max_bins_per_side = 192, .points_per_bin = 2.0, .margin_m = 0.05, .margin_per_metre = 0.01};
};

class FreeSpaceVotes {
 public:
  static constexpr std::size_t kBytesPerCell = 4;

  // Cells in order of their keys; they outlive this.
  FreeSpaceVotes(const std::vector<CellSum>& cells, const CellGrid& grid, const DynamicRemovalOptions& options = {});

  // False: the scan stands too far from all cells to have a vote.
  bool HasVote(const RigidTransform& T_map_scan) const;
  // Counts the scan's votes. Incomplete after a stop request. Runs on the threads of the innermost WithThreadLimit.
  void AddScan(const Scan& scan, const RigidTransform& T_map_scan, const Stop& stop = {});

  // Whether the cell is to be removed. With t votes for free space and s for surface: t > 2 (s - 1) and t >= 1. The
  // surface vote left out is that of the scan that the cell's points came from.
  bool IsDynamic(std::size_t cell) const {
    const int seen = votes_[cell].surface > 1 ? votes_[cell].surface - 1 : 0;
    return votes_[cell].through > 2 * seen;
  }

 private:
  struct Votes {
    uint16_t through = 0;
    uint16_t surface = 0;
  };
  // Cells of one tile.
  struct Tile {
    std::size_t begin = 0;
    std::size_t end = 0;
    Eigen::Vector3d centre;
  };
  void Vote(const FreeSpace& free_space, const RigidTransform& T_scan_map, const Tile& tile);
  bool IsNear(const Eigen::Vector3d& position, const Tile& tile) const;

  const std::vector<CellSum>& cells_;
  CellGrid grid_;
  DynamicRemovalOptions options_;
  double tile_radius_m_ = 0.0;
  std::vector<Tile> tiles_;
  std::vector<Votes> votes_;
};

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_DYNAMIC_REMOVAL_H_
