// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The cells of a map one after the other, from scans that need not fit in memory together. The first pass takes all
// scans; only when the cells outgrow their memory it keeps a part of them, and further passes, which ask again for the
// scans with points there, do the rest. The cells and their order depend on the input and cell size alone.
#ifndef CURVEREG_CORE_MAPPING_MAP_CELLS_H_
#define CURVEREG_CORE_MAPPING_MAP_CELLS_H_

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>

#include "absl/status/status.h"
#include "core/base/stop.h"
#include "core/mapping/point_map.h"

namespace curvereg {

struct MapCell {
  Eigen::Vector3i index;  // low corner in cells, from the map frame's origin
  Eigen::Vector3f mean;   // of its points [m, map frame]
  uint32_t count = 0;     // points
};

// Along Morton's curve (cell_grid.h), some thousands at a time. Errors as BuildPointMap.
using CellSink = std::function<absl::Status(std::span<const MapCell> cells)>;
absl::Status VisitMapCells(const MapInput& input, const PointMapOptions& options, const CellSink& sink,
                           const Stop& stop = {});

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_MAP_CELLS_H_
