// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The ground as a traverse saw it: one point per cell, or heights on a grid, of thousands of scans in bounded memory.
#ifndef CURVEREG_CORE_MAPPING_POINT_MAP_H_
#define CURVEREG_CORE_MAPPING_POINT_MAP_H_

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "core/rigid_transform.h"
#include "core/scan.h"
#include "core/stop.h"

namespace curvereg {

// Raw scans by index of `T_map_scan`; the map asks for one or a few at a time and may ask again for the same.
using MapScanLoader = std::function<absl::StatusOr<std::shared_ptr<const Scan>>(std::size_t index, const Stop& stop)>;

struct MapInput {
  std::vector<RigidTransform> T_map_scan;
  MapScanLoader load;
};

struct PointMapOptions {
  double cell_m = 0.1;                                    // edge of a cubic cell [m], 0.01 to 10
  double max_range_m = 0.0;                               // points farther from their sensor are left out; 0: none
  bool remove_seen_through = false;                       // leave out points that other scans' rays passed through
  std::size_t max_memory_bytes = std::size_t{256} << 20;  // for cells in work, not for the loader's scans
};

// Gives the map's points (mean of each cell's points, map frame [m]) piece by piece, in an order that depends on the
// input alone. Errors: INVALID_ARGUMENT (options), those of the loader and of `sink`, CANCELLED, DEADLINE_EXCEEDED.
using PointSink = std::function<absl::Status(std::span<const Eigen::Vector3f> points)>;
absl::Status BuildPointMap(const MapInput& input, const PointMapOptions& options, const PointSink& sink,
                           const Stop& stop = {});

// Heights over the map frame's x-y plane.
struct ElevationMap {
  double cell_m = 0.0;
  double min_x_m = 0.0;  // west edge of column 0
  double min_y_m = 0.0;  // south edge of the last row
  int num_columns = 0;
  int num_rows = 0;
  std::vector<float> heights;  // [m], row by row from the north; NaN where nothing was seen
};
// RESOURCE_EXHAUSTED: the grid would be larger than max_memory_bytes.
absl::StatusOr<ElevationMap> BuildElevationMap(const MapInput& input, const PointMapOptions& options,
                                               const Stop& stop = {});

// The grid in ESRI's ASCII format (ncols, nrows, xllcorner, yllcorner, cellsize, NODATA_value, rows from the north),
// given piece by piece.
using TextSink = std::function<absl::Status(std::string_view text)>;
absl::Status WriteEsriAscii(const ElevationMap& map, const TextSink& sink);

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_POINT_MAP_H_
