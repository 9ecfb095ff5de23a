// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Removal of returns that no surface explains: dust, mixed edges, false returns. A return stays when enough of the
// returns in nearly its direction lie at nearly its range and height. Tolerances grow with range, because ground seen
// at a grazing angle spreads its returns far apart along the beam.
#ifndef CURVEREG_CORE_SCAN_SCAN_FILTER_H_
#define CURVEREG_CORE_SCAN_SCAN_FILTER_H_

#include <Eigen/Core>
#include <vector>

#include "core/base/stop.h"

namespace curvereg {

struct IsolationOptions {
  int bins_per_side = 90;           // of the cube map: neighbours lie within about 1.5 degrees
  double min_agreeing_share = 0.3;  // of the neighbours
  int min_agreeing = 2;             // and at least this many
  double range_m = 0.3;             // |range difference| < range_m + range_per_m2 * range^2
  double range_per_m2 = 0.012;
  double height_m = 0.2;  // |height difference| < height_m + height_per_m * range
  double height_per_m = 0.01;
};

// The finite points that are not isolated, in their order. `up`: unit vector of the vertical in the sensor frame.
// O(points x neighbours). After a stop request what is returned is incomplete. Uses the threads of the innermost
// WithThreadLimit.
std::vector<Eigen::Vector3f> RemoveIsolatedReturns(const std::vector<Eigen::Vector3f>& points,
                                                   const Eigen::Vector3d& up, const IsolationOptions& options = {},
                                                   const Stop& stop = {});

}  // namespace curvereg

#endif  // CURVEREG_CORE_SCAN_SCAN_FILTER_H_
