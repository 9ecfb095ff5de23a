// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Which cells of a map other scans saw through: what moved, or was never there. Every scan near enough votes on every
// cell by what its beams passed through (core/scan/free_space.h); one scan's free space is held at a time.
#ifndef CURVEREG_CORE_MAPPING_SEEN_THROUGH_H_
#define CURVEREG_CORE_MAPPING_SEEN_THROUGH_H_

#include <cstdint>
#include <vector>

#include "core/base/rigid_transform.h"
#include "core/base/stop.h"
#include "core/mapping/cell_grid.h"
#include "core/mapping/cell_store.h"
#include "core/scan/free_space.h"
#include "core/scan/scan.h"

namespace curvereg {

struct SeenThroughOptions {
  double max_range_m = 30.0;  // farther off, directions are too coarse for small things
  // Finer than for verdicts: poses of a map are good to centimetres. Half a cell is added to margin_m.
  FreeSpaceOptions free_space = {
      .max_bins_per_side = 192, .points_per_bin = 2.0, .margin_m = 0.05, .margin_per_metre = 0.01};
};

class SeenThroughVotes {
 public:
  static constexpr std::size_t kBytesPerCell = 4;

  // Cells in order of their keys; they outlive this.
  SeenThroughVotes(const std::vector<CellSum>& cells, const CellGrid& grid, const SeenThroughOptions& options = {});

  // False: the scan stands too far from all cells to have a vote.
  bool HasVote(const RigidTransform& T_map_scan) const;
  // Counts the scan's votes. Incomplete after a stop request. Runs on the threads of the innermost WithThreadLimit.
  void AddScan(const Scan& scan, const RigidTransform& T_map_scan, const Stop& stop = {});

  // Whether clearly more scans saw through the cell than, beside one, saw surface there: t > 2 (s - 1), t >= 1. One
  // is the scan that the cell's points came from.
  bool IsSeenThrough(std::size_t cell) const {
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
  SeenThroughOptions options_;
  double tile_radius_m_ = 0.0;
  std::vector<Tile> tiles_;
  std::vector<Votes> votes_;
};

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_SEEN_THROUGH_H_
