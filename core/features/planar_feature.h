// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A feature of a bird's-eye view as a position and a direction on the levelled ground plane: all that the planar
// consensus (pose/consensus.h) needs of it. Frame: the scan's levelled frame, origin at the sensor.
#ifndef CURVEREG_CORE_FEATURES_PLANAR_FEATURE_H_
#define CURVEREG_CORE_FEATURES_PLANAR_FEATURE_H_

#include <Eigen/Core>

namespace curvereg {

struct PlanarFeature {
  Eigen::Vector2d position;      // levelled frame (x, y) [m]
  double orientation_rad = 0.0;  // direction of the dominant gradient, from +x towards +y
};

}  // namespace curvereg

#endif  // CURVEREG_CORE_FEATURES_PLANAR_FEATURE_H_
