// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What a simulated scanner can hit: ground, rocks on it and, for an indoor dome, the shell above. Exact surfaces:
// bilinear patches and ellipsoids, so every range has a true value.
//
// World frame: right-handed, z up, metres, origin at the middle of the ground.
#ifndef CURVEREG_SIM_WORLD_H_
#define CURVEREG_SIM_WORLD_H_

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "sim/height_grid.h"
#include "sim/rocks.h"

namespace curvereg::sim {

// An ellipsoid centred on the origin, seen from inside; only what is above the ground shows.
struct Shell {
  Eigen::Vector3d semi_axes = Eigen::Vector3d::Constant(20.0);

  // The t at which a ray from inside leaves the shell.
  double Intersect(const Ray& ray) const;
  // Unit normal that points inwards.
  Eigen::Vector3d NormalAt(const Eigen::Vector3d& point) const;
};

enum class Surface { kNothing, kGround, kRock, kShell };

struct Hit {
  Surface surface = Surface::kNothing;
  double range = std::numeric_limits<double>::infinity();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // of the surface, towards the ray's origin
};

// Immutable; safe to share between threads.
class World {
 public:
  World(HeightGrid ground, std::vector<Rock> rocks, std::optional<Shell> shell = std::nullopt);

  const HeightGrid& ground() const { return ground_; }
  const std::vector<Rock>& rocks() const { return rocks_; }
  const std::optional<Shell>& shell() const { return shell_; }

  // The nearest surface within max_range along a ray of unit direction. Cost: about 0.2 us outdoors.
  Hit CastRay(const Ray& ray, double max_range) const;

  // Height of ground or rock, whichever is higher; NaN outside of the ground and in its holes.
  double SurfaceHeight(double x, double y) const;

  // Whether no rock that stands out of the ground by more than min_height reaches into the circle of `radius`.
  bool IsClearOfRocks(const Eigen::Vector2d& place, double radius, double min_height) const;

 private:
  // Square of kBlockCells x kBlockCells ground cells.
  struct Block {
    double top = -std::numeric_limits<double>::infinity();  // highest ground or rock
    int first_rock = 0;                                     // into rocks_of_blocks_
    int num_rocks = 0;
  };

  void IndexGround();
  void IndexRocks();
  Eigen::Vector2i BlockOf(double x, double y) const;
  Block& BlockAt(int bx, int by) { return blocks_[static_cast<std::size_t>(by * num_blocks_x_ + bx)]; }
  const Block& BlockAt(int bx, int by) const { return blocks_[static_cast<std::size_t>(by * num_blocks_x_ + bx)]; }
  Hit CastOnGround(const Ray& ray, double max_range) const;

  HeightGrid ground_;
  std::vector<Rock> rocks_;
  std::optional<Shell> shell_;
  int num_blocks_x_ = 0;
  int num_blocks_y_ = 0;
  double top_ = -std::numeric_limits<double>::infinity();
  double bottom_ = std::numeric_limits<double>::infinity();
  std::vector<Block> blocks_;
  std::vector<int> rocks_of_blocks_;
};

}  // namespace curvereg::sim

#endif  // CURVEREG_SIM_WORLD_H_
