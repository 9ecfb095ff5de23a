// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/testing/scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

namespace curvereg::testing {
namespace {

constexpr double kMiss = std::numeric_limits<double>::infinity();

struct Ray {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;  // unit length
};

// Distance along a ray to the first surface, kMiss where there is none.
using Caster = std::function<double(const Ray&)>;

Scan ScanWorld(const RigidTransform& T_world_sensor, const ScannerOptions& options, const Caster& cast) {
  Random random(options.noise_seed);
  Scan scan;
  for (int column = 0; column < options.num_columns; ++column) {
    const double azimuth = 2.0 * std::numbers::pi * column / options.num_columns;
    for (int row = 0; row < options.num_rows; ++row) {
      const double share = (row + 0.5) / options.num_rows;
      const double elevation = std::lerp(options.min_elevation_rad, options.max_elevation_rad, share);
      const Eigen::Vector3d direction(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                      std::sin(elevation));
      const double range = cast({T_world_sensor.translation(), T_world_sensor.linear() * direction});
      if (!(range <= options.max_range_m)) continue;
      scan.points.emplace_back(((range + options.noise_m * random.Gaussian()) * direction).cast<float>());
    }
  }
  return scan;
}

// A hill (or hollow) that ends smoothly at its radius.
struct Bump {
  double x, y, radius, height;
};
struct Boulder {
  Eigen::Vector3d centre;
  double radius;
};

// Hills in square tiles, so that a place asks only those that reach it.
class Hills {
 public:
  void Add(const Bump& bump) {
    for (int row = Index(bump.y - bump.radius); row <= Index(bump.y + bump.radius); ++row) {
      for (int col = Index(bump.x - bump.radius); col <= Index(bump.x + bump.radius); ++col) {
        tiles_[static_cast<size_t>(row * kTiles + col)].push_back(bump);
      }
    }
  }
  double Height(double x, double y) const {
    double z = 0.3 * std::sin(0.11 * x + 0.4) * std::cos(0.09 * y);
    for (const Bump& bump : tiles_[static_cast<size_t>(Index(y) * kTiles + Index(x))]) {
      const double dx = x - bump.x, dy = y - bump.y;
      const double inside = 1.0 - (dx * dx + dy * dy) / (bump.radius * bump.radius);
      if (inside > 0.0) z += bump.height * inside * inside * inside;
    }
    return z;
  }

 private:
  static constexpr int kTiles = 48;
  static constexpr double kTile = 2.0;  // [m]
  static int Index(double x) { return static_cast<int>(std::clamp(x / kTile + 0.5 * kTiles, 0.0, kTiles - 1.0)); }

  std::vector<std::vector<Bump>> tiles_{kTiles * kTiles};
};

struct BumpyWorld {
  Hills hills;
  std::vector<Boulder> boulders;
};

BumpyWorld MakeBumpyWorld(uint64_t seed) {
  Random random(seed);
  BumpyWorld world;
  for (int i = 0; i < 150; ++i) {
    const double x = random.Uniform(-40.0, 40.0), y = random.Uniform(-40.0, 40.0);
    const double radius = random.Uniform(1.0, 5.0);
    world.hills.Add({x, y, radius, radius * random.Uniform(-0.16, 0.16)});
  }
  for (int i = 0; i < 120; ++i) {
    const double x = random.Uniform(-35.0, 35.0), y = random.Uniform(-35.0, 35.0);
    const double radius = random.Uniform(0.2, 0.7);
    world.boulders.push_back({{x, y, world.hills.Height(x, y) + 0.2 * radius}, radius});
  }
  return world;
}

// Walks along the ray in steps that cannot jump over a hill, then halves the last one.
double CastOnGround(const Hills& hills, const Ray& ray, double max_range_m) {
  constexpr double kSlope = 1.0;  // steepest ground walked on
  const auto gap = [&](double range) {
    const Eigen::Vector3d p = ray.origin + range * ray.direction;
    return p.z() - hills.Height(p.x(), p.y());
  };
  double before = 0.0;
  double range = 0.0;
  for (double height = gap(0.0); height > 0.0; height = gap(range)) {
    before = range;
    range += std::max(0.02, height / (kSlope + std::abs(ray.direction.z())));
    if (range > max_range_m) return kMiss;
  }
  for (int i = 0; i < 20; ++i) (gap(0.5 * (before + range)) > 0.0 ? before : range) = 0.5 * (before + range);
  return range;
}

double CastOnBoulder(const Boulder& boulder, const Ray& ray) {
  const Eigen::Vector3d to_centre = boulder.centre - ray.origin;
  const double along = to_centre.dot(ray.direction);
  const double squared = boulder.radius * boulder.radius - (to_centre.squaredNorm() - along * along);
  return along > 0.0 && squared > 0.0 ? along - std::sqrt(squared) : kMiss;
}

struct Box {
  Eigen::Array3d low, high;
};

struct Interval {
  double enter, leave;
};

Interval CastThroughBox(const Box& box, const Ray& ray) {
  const Eigen::Array3d a = (box.low - ray.origin.array()) / ray.direction.array();
  const Eigen::Array3d b = (box.high - ray.origin.array()) / ray.direction.array();
  return {a.min(b).maxCoeff(), a.max(b).minCoeff()};
}

}  // namespace

double Random::Uniform() {
  // SplitMix64.
  state_ += 0x9E3779B97F4A7C15ULL;
  uint64_t z = state_;
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
  return static_cast<double>((z ^ (z >> 31U)) >> 11U) * 0x1p-53;
}

double Random::Gaussian() {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - Uniform()));
  return radius * std::cos(2.0 * std::numbers::pi * Uniform());
}

RigidTransform UprightPose(double x, double y, double yaw_rad, double height_m) {
  RigidTransform T_world_sensor = RigidTransform::Identity();
  T_world_sensor.linear() = RotationFromVector({0.0, 0.0, yaw_rad});
  T_world_sensor.translation() << x, y, height_m;
  return T_world_sensor;
}

RigidTransform RoverPose(double x, double y, double yaw_rad, double height_m, uint64_t world_seed) {
  RigidTransform T_world_sensor = UprightPose(x, y, yaw_rad, BumpyHeight(x, y, world_seed) + height_m);
  T_world_sensor.rotate(RotationFromVector({0.03 * std::sin(x + y), 0.03 * std::cos(x - y), 0.0}));
  return T_world_sensor;
}

double BumpyHeight(double x, double y, uint64_t world_seed) { return MakeBumpyWorld(world_seed).hills.Height(x, y); }

Scan BumpyGround(const RigidTransform& T_world_sensor, const ScannerOptions& options) {
  const BumpyWorld world = MakeBumpyWorld(options.world_seed);
  return ScanWorld(T_world_sensor, options, [&](const Ray& ray) {
    double range = CastOnGround(world.hills, ray, options.max_range_m);
    for (const Boulder& boulder : world.boulders) range = std::min(range, CastOnBoulder(boulder, ray));
    return range;
  });
}

Scan FlatGround(const RigidTransform& T_world_sensor, const ScannerOptions& options) {
  return ScanWorld(T_world_sensor, options, [](const Ray& ray) {
    return ray.direction.z() < 0.0 ? -ray.origin.z() / ray.direction.z() : kMiss;
  });
}

Scan FurnishedHall(const RigidTransform& T_world_sensor, const ScannerOptions& options) {
  static constexpr std::array<std::array<double, 6>, 9> kFurniture = {{{-7.0, 3.8, 0.0, -4.5, 5.0, 2.2},
                                                                       {5.9, -4.0, 0.0, 7.0, -1.0, 2.5},
                                                                       {2.0, 2.2, 0.0, 3.6, 3.0, 0.8},
                                                                       {-2.8, -3.1, 0.0, -2.0, -1.4, 0.75},
                                                                       {-6.0, -4.6, 0.0, -5.0, -3.9, 1.6},
                                                                       {0.3, 4.2, 0.0, 1.6, 5.0, 3.1},
                                                                       {4.4, 0.6, 0.0, 4.9, 1.5, 1.1},
                                                                       {-4.1, 0.9, 0.0, -3.4, 1.3, 1.9},
                                                                       {1.1, -5.0, 0.0, 2.9, -4.3, 2.0}}};
  const Box hall{{-7.0, -5.0, 0.0}, {7.0, 5.0, 4.0}};
  return ScanWorld(T_world_sensor, options, [&](const Ray& ray) {
    double range = CastThroughBox(hall, ray).leave;
    for (const auto& [x0, y0, z0, x1, y1, z1] : kFurniture) {
      const Interval hit = CastThroughBox({{x0, y0, z0}, {x1, y1, z1}}, ray);
      if (hit.enter > 0.0 && hit.enter < hit.leave) range = std::min(range, hit.enter);
    }
    return range;
  });
}

std::vector<Eigen::Vector3f> PatchPoints(const PlanePatch& patch, int num_points, uint64_t seed) {
  Random random(seed);
  const Eigen::Vector3d normal = patch.normal.normalized();
  const Eigen::Vector3d u = normal.unitOrthogonal();
  const Eigen::Vector3d v = normal.cross(u);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < num_points; ++i) {
    const double along_u = patch.side_m * random.Uniform(-0.5, 0.5);
    const double along_v = patch.side_m * random.Uniform(-0.5, 0.5);
    const double off = patch.noise_m * random.Gaussian();
    points.emplace_back((patch.centre + along_u * u + along_v * v + off * normal).cast<float>());
  }
  return points;
}

}  // namespace curvereg::testing
