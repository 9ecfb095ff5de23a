// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/point_map.h"

#include "core/mapping/map_cells.h"

namespace curvereg {

absl::Status BuildPointMap(const MapInput& input, const PointMapOptions& options, const PointSink& sink,
                           const Stop& stop) {
  std::vector<Eigen::Vector3f> points;
  const CellSink give_means = [&](std::span<const MapCell> cells) {
    points.clear();
    for (const MapCell& cell : cells) points.push_back(cell.mean);
    return sink(points);
  };
  return VisitMapCells(input, options, give_means, stop);
}

}  // namespace curvereg
