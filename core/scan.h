// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A scan: the points of one sweep of a laser scanner, taken from (nearly) one place.
//
// Frame: the sensor frame, right-handed, origin at the sensor's optical centre, metres. Any attitude; where the method
// needs a vertical it finds one (leveling.h) or takes `gravity`. Order of points carries no meaning to the method.
#ifndef CURVEREG_CORE_SCAN_H_
#define CURVEREG_CORE_SCAN_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "core/stop.h"

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

// 16 hexadecimal digits (XXH3-64 of the packed little-endian float32 coordinates and the gravity vector, if any):
// equal scans have equal digests.
std::string ScanDigest(const Scan& scan);

// The same digest of points that come piece by piece, and how many of them are finite. Movable.
class ScanDigester {
 public:
  ScanDigester();
  ScanDigester(ScanDigester&&) noexcept;
  ScanDigester& operator=(ScanDigester&&) noexcept;
  ~ScanDigester();

  // More bytes of the packed little-endian float32 coordinates, cut anywhere.
  void Update(std::string_view bytes);
  std::string Digest(const std::optional<Eigen::Vector3d>& gravity) const;
  int64_t num_finite_points() const;  // of the points that are complete

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// The scan seen from another frame: points and gravity mapped by T_new_old. Points that are not finite stay so.
Scan TransformScan(const Scan& scan, const Eigen::Isometry3d& T_new_old);

}  // namespace curvereg

#endif  // CURVEREG_CORE_SCAN_H_
