// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The views: a scan as an image. Bird's-eye views look down the levelled frame's z axis with the sensor at the image
// centre: column grows with x, row with y. Values are metres (elevation) or counts (occupancy).
#ifndef CURVEREG_CORE_VIEWS_SCAN_IMAGE_H_
#define CURVEREG_CORE_VIEWS_SCAN_IMAGE_H_

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/base/image.h"
#include "core/base/stop.h"

namespace curvereg {

struct BirdsEyeOptions {
  double cell_m = 0.25;  // 0.25 m shows rocks and ripples; 0.4 m suits occupancy
  int size = 256;        // cells per side: 64 m of ground
  bool median = false;   // elevation: a cell's median height instead of its mean; slower, for scans with false returns
};

// A view from above. Pixel (row, col) covers x in [(col - size/2) * cell, +cell), y likewise with row.
struct BirdsEyeImage {
  Image<float> values;
  Image<uint8_t> valid;  // 1 where a return fell into the cell
  double cell_m = 0.25;

  // Levelled-frame position [m] of the image coordinate (row, col), pixel centres at integers.
  Eigen::Vector2d PositionOf(double row, double col) const {
    return {(col - 0.5 * values.cols + 0.5) * cell_m, (row - 0.5 * values.rows + 0.5) * cell_m};
  }
  // Image coordinate (row, col) of a levelled-frame position; inverse of PositionOf.
  Eigen::Vector2d PixelOf(const Eigen::Vector2d& position) const {
    return {position.y() / cell_m + 0.5 * values.rows - 0.5, position.x() / cell_m + 0.5 * values.cols - 0.5};
  }
};

// Mean (or median) height [m] of the returns in each cell, in the levelled frame (0 at the sensor); 0 and invalid where
// none fell. Points that are not finite are skipped. Incomplete after a stop request.
BirdsEyeImage ElevationImage(const std::vector<Eigen::Vector3f>& points, const Eigen::Matrix3d& R_level_sensor,
                             const BirdsEyeOptions& options = {}, const Stop& stop = {});

// Which 0.5 m height slices of each cell hold a return: bit k is height [k - 32, k - 31) * 0.5 m.
struct OccupancySlices {
  static constexpr double kSliceM = 0.5;
  static constexpr int kNumSlices = 64;
  Image<uint64_t> slices;
  double cell_m = 0.4;
};
// Incomplete after a stop request.
OccupancySlices ComputeOccupancySlices(const std::vector<Eigen::Vector3f>& points,
                                       const Eigen::Matrix3d& R_level_sensor, const BirdsEyeOptions& options,
                                       const Stop& stop = {});

// Number of occupied slices per cell: high on walls, trunks and rocks, whatever the attitude showed of them.
BirdsEyeImage OccupancyImage(const OccupancySlices& slices);

}  // namespace curvereg

#endif  // CURVEREG_CORE_VIEWS_SCAN_IMAGE_H_
