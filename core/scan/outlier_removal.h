// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Outlier removal: returns that no surface explains, such as dust, mixed pixels at edges and false returns. A return
// stays when enough of the returns in nearly its direction lie at nearly its range and height. This counts neighbours
// in a cone about the beam, where the usual radius filter counts them in a ball; the rule is the project's own.
// Tolerances grow with range, because ground at a grazing angle spreads its returns far apart along the beam.
#ifndef CURVEREG_CORE_SCAN_OUTLIER_REMOVAL_H_
#define CURVEREG_CORE_SCAN_OUTLIER_REMOVAL_H_

#include <Eigen/Core>
#include <vector>

#include "core/base/stop.h"

namespace curvereg {

struct OutlierRemovalOptions {
  int bins_per_side = 90;           // of the cube map: neighbours lie within about 1.5 degrees
  double min_agreeing_share = 0.3;  // of the neighbours
  int min_agreeing = 2;             // and at least this many
  double range_m = 0.3;             // |range difference| < range_m + range_per_m2 * range^2
  double range_per_m2 = 0.012;
  double height_m = 0.2;  // |height difference| < height_m + height_per_m * range
  double height_per_m = 0.01;
};

// The finite points that are not outliers, in their order. `up`: unit vector of the vertical in the sensor frame.
// O(points x neighbours). After a stop request what is returned is incomplete. Uses the threads of the innermost
// WithThreadLimit.
std::vector<Eigen::Vector3f> RemoveOutliers(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3d& up,
                                            const OutlierRemovalOptions& options = {}, const Stop& stop = {});

}  // namespace curvereg

#endif  // CURVEREG_CORE_SCAN_OUTLIER_REMOVAL_H_
