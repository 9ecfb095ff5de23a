// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The ground as heights over the map frame's x-y plane, from thousands of scans in bounded memory. x points east and y
// north. A cell's height is the mean of the heights of all points in its column, as digital elevation models have it:
// what overhangs counts, too. So a cell of 0.2 m is the mean over the points of its four cells of 0.1 m.
#ifndef CURVEREG_CORE_MAPPING_ELEVATION_MAP_H_
#define CURVEREG_CORE_MAPPING_ELEVATION_MAP_H_

#include <functional>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/stop.h"
#include "core/mapping/point_map.h"

namespace curvereg {

// Cell faces lie at whole multiples of the cell size. Empty (no columns, no rows) when nothing was seen.
struct ElevationMap {
  double cell_m = 0.0;
  double min_x_m = 0.0;  // west edge of column 0
  double min_y_m = 0.0;  // south edge of the last row
  int num_columns = 0;
  int num_rows = 0;
  std::vector<float> heights;  // [m], row by row from the north; NaN where nothing was seen
};

// max_memory_bytes holds the cells in work and the columns (16 bytes each, in squares of 256), half of it each at most;
// then the columns and the grid. Errors as BuildPointMap; RESOURCE_EXHAUSTED: the columns, or the grid about all
// points, do not fit.
absl::StatusOr<ElevationMap> BuildElevationMap(const MapInput& input, const PointMapOptions& options,
                                               const Stop& stop = {});

// The grid in ESRI's ASCII format (ncols, nrows, xllcorner, yllcorner, cellsize, NODATA_value -9999, rows from the
// north; heights to 0.1 mm), given piece by piece. Errors of `sink`.
using TextSink = std::function<absl::Status(std::string_view text)>;
absl::Status WriteEsriAscii(const ElevationMap& map, const TextSink& sink);

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_ELEVATION_MAP_H_
