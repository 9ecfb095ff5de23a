// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A scan: the points of one sweep of a laser scanner, taken from (nearly) one place.
//
// Frame: the sensor frame, right-handed, origin at the sensor's optical centre, metres. Any attitude; where the method
// needs a vertical it finds one (leveling.h) or takes `gravity`. Order of points carries no meaning to the method.
#ifndef CURVEREG_CORE_SCAN_SCAN_H_
#define CURVEREG_CORE_SCAN_SCAN_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "core/base/stop.h"

namespace curvereg {

struct Scan {
  std::vector<Eigen::Vector3f> points;     // sensor frame [m]; entries that are not finite are "no return" and skipped
  std::optional<Eigen::Vector3d> gravity;  // direction of gravity (down) in the sensor frame, any length > 0
};

// What a scan must be to take part in a registration; the first broken rule is named in the error.
struct ScanLimits {
  int64_t min_points = 100;         // finite points needed; below it nothing can be fitted to
  int64_t max_points = 50'000'000;  // refuses what would not fit in memory
  double max_coordinate_m = 100e3;  // |x|, |y|, |z| above it are refused: not a scan in metres
};

// OK, or INVALID_ARGUMENT: fewer finite points than min_points, more than max_points, a coordinate beyond the limit,
// all points equal or on one line, gravity zero or not finite. Cost: one pass; OK without a full look once `stop` is
// requested.
absl::Status ValidateScan(const Scan& scan, const ScanLimits& limits = {}, const Stop& stop = {});

// Points that are finite, i.e. returns.
int64_t CountFinitePoints(const Scan& scan);

// 16 hexadecimal digits (XXH3-64 of the packed little-endian float32 coordinates and the gravity vector, if any):
// equal scans have equal digests.
std::string ScanDigest(const Scan& scan);

// The same from the XXH3-64 of the coordinates, for those who computed it on the way.
std::string ScanDigestOfHash(uint64_t points_hash, const std::optional<Eigen::Vector3d>& gravity);

// Counts the finite ones of points that come piece by piece.
class FinitePointCounter {
 public:
  // More bytes of the packed little-endian float32 coordinates, cut anywhere.
  void Update(std::string_view bytes);
  int64_t count() const { return count_; }  // of the points that are complete

 private:
  int64_t count_ = 0;
  std::array<char, sizeof(Eigen::Vector3f)> partial_{};  // the beginning of a point
  std::size_t partial_size_ = 0;
};

// The scan seen from another frame: points and gravity mapped by T_new_old. Points that are not finite stay so.
Scan TransformScan(const Scan& scan, const Eigen::Isometry3d& T_new_old);

}  // namespace curvereg

#endif  // CURVEREG_CORE_SCAN_SCAN_H_
