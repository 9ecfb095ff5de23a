// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The views from the sensor: a scan as a panorama over azimuth and elevation about the sensor frame's z axis. Range is
// what the paper registers by; the bearing angle tells shape without the steps in range from near to far. The nearest
// return of each pixel is kept, and which point it was. All around: column 0 is the neighbour of the last column.
// Deterministic: of returns equally near the first in the scan is kept. O(points + pixels).
#ifndef CURVEREG_CORE_VIEWS_RANGE_IMAGE_H_
#define CURVEREG_CORE_VIEWS_RANGE_IMAGE_H_

#include <Eigen/Core>
#include <cstdint>
#include <numbers>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/image.h"

namespace curvereg {

struct RangeImageOptions {
  // Size of a pixel in both directions, in [0.0005, 0.2]; rounded so that the circle holds whole pixels. Default: half
  // a degree, the paper's resolution, 720 columns.
  double step_rad = std::numbers::pi / 360.0;
  // False: the rows that hold returns. True: from zenith to nadir, 360 rows at half a degree.
  bool full_sphere = false;
  // The rows with returns are widened evenly to at least this many (never beyond the sphere), so that a scanner of
  // small vertical field leaves room for the scales of a transform. 0: leave alone.
  int min_rows = 0;
};

// Row 0 looks up most; columns run from azimuth +pi clockwise seen from above, so +x is in the middle and +y left of
// it.
struct RangeImage {
  Image<float> range;    // [m], 0 where invalid
  Image<uint8_t> valid;  // 1 where a return fell into the pixel
  Image<int32_t> point;  // index of the nearest return in the scan's points, -1 where invalid
  double step_rad = 0.0;
  int first_row = 0;  // rows of the full sphere above row 0

  // Direction of the image coordinate (row, col), pixel centres at integers [rad].
  double ElevationOf(double row) const { return std::numbers::pi / 2.0 - (first_row + row + 0.5) * step_rad; }
  double AzimuthOf(double col) const { return std::numbers::pi - (col + 0.5) * step_rad; }
};

// Points [m] in the sensor frame; those not finite or at the origin are skipped. Without any other point the image is
// 0 x 0 (full_sphere or not). INVALID_ARGUMENT: an option out of range, or more than 2^31 - 1 points.
absl::StatusOr<RangeImage> ComputeRangeImage(const std::vector<Eigen::Vector3f>& points,
                                             const RangeImageOptions& options = {});

enum class BearingDirection {
  kAlongColumn,  // to the neighbour below: on level ground the angle is the beam's depression, on a wall about pi / 2
  kAlongRow,     // to the neighbour on the left, across the seam too
};

struct BearingAngleOptions {
  BearingDirection direction = BearingDirection::kAlongColumn;
  int max_gap_px =
      3;  // the neighbour is the next return within that many pixels, >= 1: rings of beams leave rows empty
};

struct BearingAngleImage {
  Image<float> angle;    // [rad] in [0, pi], 0 where invalid
  Image<uint8_t> valid;  // 1 where the pixel and a neighbour hold returns at different places
};

// The bearing angle: between the beam back to the sensor and the line from its return to the neighbour's, [Scaramuzza,
// Harati, Siegwart, "Extrinsic self calibration of a camera and a 3D laser range finder from natural scenes", IROS
// 2007, eq. (1)]: cos BA_i = (r_i - r_{i-1} cos dphi) / sqrt(r_i^2 + r_{i-1}^2 - 2 r_i r_{i-1} cos dphi), with the true
// angle dphi between the two beams. Precondition: `image` was made of `points`.
BearingAngleImage ComputeBearingAngles(const RangeImage& image, const std::vector<Eigen::Vector3f>& points,
                                       const BearingAngleOptions& options = {});

}  // namespace curvereg

#endif  // CURVEREG_CORE_VIEWS_RANGE_IMAGE_H_
