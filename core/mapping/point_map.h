// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The ground as a traverse saw it: one point per cubic cell, of thousands of scans in bounded memory. Any cell size is
// a level of detail: a coarser map takes less memory and time, and its cells are made of whole cells of one twice as
// fine.
#ifndef CURVEREG_CORE_MAPPING_POINT_MAP_H_
#define CURVEREG_CORE_MAPPING_POINT_MAP_H_

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/rigid_transform.h"
#include "core/base/stop.h"
#include "core/scan/scan.h"

namespace curvereg {

// Raw scans by index of `T_map_scan`; the map asks for one or a few at a time and may ask again for the same.
using MapScanLoader = std::function<absl::StatusOr<std::shared_ptr<const Scan>>(std::size_t index, const Stop& stop)>;

struct MapInput {
  std::vector<RigidTransform> T_map_scan;
  MapScanLoader load;
};

struct PointMapOptions {
  double cell_m = 0.1;          // edge of a cubic cell [m], 0.01 to 10
  double max_range_m = 0.0;     // points farther from their sensor are left out; 0: none
  bool remove_dynamic = false;  // leave out cells in the free space of other scans (dynamic_removal.h)
  std::size_t max_memory_bytes = std::size_t{256}
                                 << 20;  // for cells in work, not for the loader's scans; 64 KiB or more
};

// Gives the map's points (mean of each cell's points, map frame [m]) piece by piece, in an order that depends on the
// input and cell size alone. Points that are not finite, or 2^20 cells (105 km at 0.1 m) and more from the middle of
// all sensors along an axis, are left out. Scans are asked for one at a time, in order: once where the cells fit into
// max_memory_bytes (36 bytes each, 40 with remove_dynamic), else again for each part of the map; once more with
// remove_dynamic. Errors: INVALID_ARGUMENT (options, poses), those of the loader and of `sink`, CANCELLED,
// DEADLINE_EXCEEDED.
using PointSink = std::function<absl::Status(std::span<const Eigen::Vector3f> points)>;
absl::Status BuildPointMap(const MapInput& input, const PointMapOptions& options, const PointSink& sink,
                           const Stop& stop = {});

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_POINT_MAP_H_
