// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// How sharp a map is: the thickness of its surfaces where several scans saw them. Wrong poses double the surfaces, so
// the thickness grows; it needs no truth.
#ifndef CURVEREG_EVAL_SURFACE_THICKNESS_H_
#define CURVEREG_EVAL_SURFACE_THICKNESS_H_

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/base/rigid_transform.h"
#include "core/mapping/cell_grid.h"
#include "core/scan/scan.h"

namespace curvereg {

// Scans are added one by one; only moments per cell are held. Not safe for several threads at once.
class SurfaceThickness {
 public:
  // Edge of the cubic cells [m]: small enough for a cell's ground to be nearly plane. Precondition: > 0.
  explicit SurfaceThickness(double cell_m = 0.25);

  // Points that are not finite, or farther than a million cells from the origin, are left out.
  void Add(const Scan& scan, const RigidTransform& T_map_scan);

  struct Result {
    double median_m = 0.0;  // over those cells, of the standard deviation across the surface; NaN without cells
    double p90_m = 0.0;
    int64_t num_cells = 0;  // with at least two scans of at least five points each
  };
  Result Measure() const;

 private:
  struct Cell {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();  // of offsets from the cell's centre [m]
    Eigen::Matrix3d sum_of_squares = Eigen::Matrix3d::Zero();
    int64_t count = 0;
    int last_scan = -1;
    int points_of_last_scan = 0;
    int num_scans = 0;  // that gave enough points
  };

  CellGrid grid_;
  int num_scans_ = 0;
  std::unordered_map<uint64_t, std::size_t> index_of_;  // keys of the grid → index in cells_
  std::vector<Cell> cells_;
};

}  // namespace curvereg

#endif  // CURVEREG_EVAL_SURFACE_THICKNESS_H_
