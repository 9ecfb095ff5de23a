// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/landforms.h"

#include <Eigen/Geometry>
#include <cmath>

#include "sim/fractal_noise.h"
#include "sim/random.h"

namespace curvereg::sim {

double Hill::HeightAt(const Eigen::Vector2d& place) const {
  return height_m * std::exp(-0.5 * (place - centre).squaredNorm() / (sigma_m * sigma_m));
}

double Ridge::HeightAt(const Eigen::Vector2d& place) const {
  const Eigen::Vector2d local = Eigen::Rotation2Dd(-direction_rad) * (place - centre);
  const double along = local.x() / half_length_m;
  const double across = (local.y() - bend_m * along * along) / sigma_m;
  // A flat crest with soft ends: 1 in the middle, 1/2 at |along| = 1.
  const double taper = 1.0 / (1.0 + std::pow(along, 6.0));
  return height_m * taper * std::exp(-0.5 * across * across);
}

double Crater::HeightAt(const Eigen::Vector2d& place) const {
  const double r = (place - centre).norm() / radius_m;
  if (r < 1.0) return rim_m - (depth_m + rim_m) * (1.0 - r * r);
  // Half the rim is left a quarter radius outside of the crest.
  const double outwards = (r - 1.0) / 0.25;
  return rim_m * std::exp2(-outwards * outwards);
}

void AddGravel(double sigma_m, uint64_t key, HeightGrid* grid) {
  constexpr double kPatchSize = 4.0;
  for (int row = 0; row < grid->heights.rows; ++row) {
    for (int col = 0; col < grid->heights.cols; ++col) {
      RandomStream random(SubKey(key, grid->heights.Index(row, col)));
      const double x = grid->x_min + grid->cell * col;
      const double y = grid->y_min + grid->cell * row;
      const double coarseness = 1.0 + 0.7 * ValueNoise(x / kPatchSize, y / kPatchSize, key);
      grid->heights(row, col) += static_cast<float>(sigma_m * coarseness * random.Normal());
    }
  }
}

}  // namespace curvereg::sim
