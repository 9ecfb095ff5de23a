// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/rocks.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

#include "sim/random.h"

namespace curvereg::sim {
namespace {

// The inverse of the truncated power law's distribution at u in [0, 1).
double PowerLawDiameter(const RockOptions& options, double u) {
  const double share_at_max = std::pow(options.max_diameter_m / options.min_diameter_m, -options.exponent);
  const double share = 1.0 - u * (1.0 - share_at_max);
  return options.min_diameter_m * std::pow(share, -1.0 / options.exponent);
}

Rock MakeRock(double diameter, double relief, RandomStream& random) {
  const double long_axis = 0.5 * diameter;
  const double middle_axis = long_axis * random.Uniform(0.65, 1.0);
  const double short_axis = long_axis * random.Uniform(0.45, 0.9);
  const double yaw = random.Uniform(0.0, 2.0 * std::numbers::pi);
  const double tilt_direction = random.Uniform(0.0, 2.0 * std::numbers::pi);
  const Eigen::Vector3d tilt_axis(std::cos(tilt_direction), std::sin(tilt_direction), 0.0);
  const Eigen::Matrix3d attitude =
      (Eigen::AngleAxisd(random.Uniform(0.0, 0.6), tilt_axis) * Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  const Eigen::Matrix3d from_unit = Eigen::Vector3d(1.0, 1.0, relief).asDiagonal() * attitude *
                                    Eigen::Vector3d(long_axis, middle_axis, short_axis).asDiagonal();
  Rock rock;
  rock.to_unit = from_unit.inverse();
  rock.half_extent = from_unit.rowwise().norm();
  rock.centre.z() = rock.half_extent.z() * random.Uniform(-0.4, 0.5);  // above the ground
  return rock;
}

}  // namespace

double Rock::Intersect(const Ray& ray) const {
  const Eigen::Vector3d offset = to_unit * (ray.origin - centre);
  const Eigen::Vector3d direction = to_unit * ray.direction;
  const double q2 = direction.squaredNorm();
  const double q1 = offset.dot(direction);
  const double discriminant = q1 * q1 - q2 * (offset.squaredNorm() - 1.0);
  if (discriminant < 0.0) return std::numeric_limits<double>::infinity();
  const double t = (-q1 - std::sqrt(discriminant)) / q2;
  return t >= 0.0 ? t : std::numeric_limits<double>::infinity();
}

Eigen::Vector3d Rock::NormalAt(const Eigen::Vector3d& point) const {
  return (to_unit.transpose() * (to_unit * (point - centre))).normalized();
}

std::vector<Rock> ScatterRocks(const HeightGrid& grid, const RockOptions& options, double relief, uint64_t key) {
  const double area = (grid.x_max() - grid.x_min) * (grid.y_max() - grid.y_min);
  const auto num_small = static_cast<int>(std::lround(area * options.density_per_m2));
  std::vector<Rock> rocks;
  rocks.reserve(static_cast<std::size_t>(num_small + options.num_boulders));
  for (int i = 0; i < num_small + options.num_boulders; ++i) {
    RandomStream random(SubKey(key, static_cast<uint64_t>(i)));
    const double x = random.Uniform(grid.x_min, grid.x_max());
    const double y = random.Uniform(grid.y_min, grid.y_max());
    const double diameter = i < num_small
                                ? PowerLawDiameter(options, random.Uniform())
                                : random.Uniform(options.boulder_min_diameter_m, options.boulder_max_diameter_m);
    Rock rock = MakeRock(diameter, relief, random);
    const double ground = grid.HeightAt(x, y);
    if (std::isnan(ground)) continue;
    rock.centre += Eigen::Vector3d(x, y, ground);
    rocks.push_back(rock);
  }
  return rocks;
}

}  // namespace curvereg::sim
