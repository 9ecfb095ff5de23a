// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Candidate verticals of a scan: the directions most of its surface faces (the ground, a floor, then walls), or the
// gravity vector given. A levelling rotation turns the sensor frame so that the vertical becomes +z; bird's-eye views
// are taken in that frame. Peaks of the extended Gaussian image [EGI], the distribution of surface area over normals,
// found by greedy clustering of planar surfels weighted by cell area. The choice of thresholds is in docs/method.md.
#ifndef CURVEREG_CORE_SCAN_LEVELING_H_
#define CURVEREG_CORE_SCAN_LEVELING_H_

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/scan/voxel_map.h"

namespace curvereg {

struct LevelingOptions {
  double planarity = 0.08;           // a surfel is planar when its normal deviation is below this share of its cell
  double cluster_rad = 0.0873;       // 5 degrees: normals this near to each other (or opposite) are one direction
  double min_relative_weight = 0.6;  // a second direction counts only with this share of the first one's weight
  int max_candidates = 2;
};

struct LevelingCandidate {
  Eigen::Matrix3d R_level_sensor = Eigen::Matrix3d::Identity();  // turns the vertical to +z
  double weight = 0.0;  // area of the surface that faces it [m^2]; 0 for a given gravity
};

// Strongest first; never empty: without any planar surfel, the sensor's own z axis. With `gravity` (down, sensor
// frame) exactly that one. `maps` from fine to coarse; the finest level is not used (it starves on sparse ground
// rings).
std::vector<LevelingCandidate> FindVerticals(const std::vector<VoxelMap>& maps,
                                             const std::optional<Eigen::Vector3d>& gravity,
                                             const LevelingOptions& options = {});

}  // namespace curvereg

#endif  // CURVEREG_CORE_SCAN_LEVELING_H_
