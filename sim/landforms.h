// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The landforms that worlds are put together from; each a smooth height over the plane [m].
#ifndef CURVEREG_SIM_LANDFORMS_H_
#define CURVEREG_SIM_LANDFORMS_H_

#include <Eigen/Core>
#include <cstdint>

#include "sim/height_grid.h"

namespace curvereg::sim {

// A round Gaussian hill; sigma is its radius at 61 % of the height.
struct Hill {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double sigma_m = 5.0;
  double height_m = 1.0;

  double HeightAt(const Eigen::Vector2d& place) const;
};

// A wall of Gaussian profile along an arc-shaped crest, tapered at both ends.
struct Ridge {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double direction_rad = 0.0;
  double half_length_m = 12.0;
  double bend_m = 2.0;  // how far the crest's ends lie off its tangent in the middle
  double sigma_m = 1.5;
  double height_m = 1.0;

  double HeightAt(const Eigen::Vector2d& place) const;
};

// A parabolic bowl with a raised rim that falls off outwards.
struct Crater {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double radius_m = 8.0;
  double depth_m = 1.6;
  double rim_m = 0.5;

  double HeightAt(const Eigen::Vector2d& place) const;
};

// Adds independent normal heights of deviation sigma_m to the vertices, more in some patches than in others.
void AddGravel(double sigma_m, uint64_t key, HeightGrid* grid);

}  // namespace curvereg::sim

#endif  // CURVEREG_SIM_LANDFORMS_H_
