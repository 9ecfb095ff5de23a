// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Surfels of a scan on cubic grids: per cell the mean, covariance and normal of its points, the cells of the normal
// distributions transform [NDT]. Built once per scan in the sensor frame; levelling finds planes among them, refinement
// aligns the source's surfels to the target's. The coarser levels are sums of the finer one's moments, so three levels
// cost one pass over the points.
// Grids are aligned with the sensor frame's origin. Moments are summed in a fixed order: same bytes at any thread
// count.
#ifndef CURVEREG_CORE_SCAN_VOXEL_MAP_H_
#define CURVEREG_CORE_SCAN_VOXEL_MAP_H_

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/base/stop.h"

namespace curvereg {

struct Surfel {
  Eigen::Vector3f mean;          // [m]
  Eigen::Vector3f normal;        // unit eigenvector of the smallest variance, pointing to the sensor's side
  Eigen::Matrix3f covariance;    // [m^2]
  Eigen::Vector3f first_point;   // the first of the cell's points in the scan's order, as measured [m]
  float normal_variance = 0.0F;  // smallest eigenvalue [m^2]
  float middle_variance = 0.0F;  // middle eigenvalue [m^2]; small when the points lie on a line
  int count = 0;                 // points in the cell
  bool has_normal = false;       // false when the points lie on a line (one scan ring): the normal means nothing
};

// Cells with enough points of one grid, findable by position.
class VoxelMap {
 public:
  VoxelMap() = default;
  // Surfels and the packed keys of their cells, same order, distinct keys.
  VoxelMap(double cell_m, std::vector<Surfel> surfels, const std::vector<uint64_t>& keys);

  double cell_m() const { return cell_m_; }
  const std::vector<Surfel>& surfels() const { return surfels_; }
  // Index of the surfel whose cell holds `point` [m], -1 where there is none.
  int Find(const Eigen::Vector3f& point) const;
  // Heap memory that the map holds.
  size_t MemoryBytes() const {
    return surfels_.capacity() * sizeof(Surfel) + slot_keys_.capacity() * sizeof(uint64_t) +
           slot_surfels_.capacity() * sizeof(int32_t);
  }

 private:
  double cell_m_ = 1.0;
  float inverse_cell_ = 1.0F;
  std::vector<Surfel> surfels_;
  std::vector<uint64_t> slot_keys_;  // open addressing, power-of-two size
  std::vector<int32_t> slot_surfels_;
  int shift_ = 0;
};

struct VoxelOptions {
  double finest_cell_m = 0.5;  // a few returns per cell at the ranges that matter; finer cells starve
  int num_levels = 3;          // each twice as coarse as the one before
  int min_points = 6;          // fewer do not carry a normal
};

// Levels from fine to coarse. Points that are not finite are skipped. Empty input gives empty levels.
// O(points). Incomplete after a stop request. Runs on the threads of the innermost WithThreadLimit.
std::vector<VoxelMap> BuildVoxelMaps(const std::vector<Eigen::Vector3f>& points, const VoxelOptions& options = {},
                                     const Stop& stop = {});

}  // namespace curvereg

#endif  // CURVEREG_CORE_SCAN_VOXEL_MAP_H_
