// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// One thinned cloud out of many placed scans: a point per occupied cubic cell, the mean of the points in it.
#ifndef CURVEREG_EVAL_MERGED_MAP_H_
#define CURVEREG_EVAL_MERGED_MAP_H_

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/rigid_transform.h"
#include "core/scan.h"

namespace curvereg {

// Scans are added one by one, so only the thinned cloud is held in memory. Not safe for several threads at once.
class MergedMap {
 public:
  // Precondition: cell_size_m > 0.
  explicit MergedMap(double cell_size_m);

  // Points that are not finite, or farther than a million cells from the origin, are left out.
  void Add(const Scan& scan, const RigidTransform& T_world_scan);

  // The means, in the order in which their cells were first hit. World frame [m], rounded to float32.
  Scan Points() const;

 private:
  struct Cell {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int64_t count = 0;
  };

  double cell_size_m_;
  std::unordered_map<uint64_t, std::size_t> index_of_;  // packed cell coordinates → index in cells_
  std::vector<Cell> cells_;
};

}  // namespace curvereg

#endif  // CURVEREG_EVAL_MERGED_MAP_H_
