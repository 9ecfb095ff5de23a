// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/world.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/grid_walk.h"

namespace curvereg::sim {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();
constexpr int kBlockCells = 8;

// Narrows [t_begin, t_end] to where low <= origin + t * direction <= high.
void ClipToSlab(double origin, double direction, double low, double high, double* t_begin, double* t_end) {
  if (direction == 0.0) {
    if (origin < low || origin > high) *t_end = -kNone;
    return;
  }
  const double t_low = (low - origin) / direction;
  const double t_high = (high - origin) / direction;
  *t_begin = std::max(*t_begin, std::min(t_low, t_high));
  *t_end = std::min(*t_end, std::max(t_low, t_high));
}

}  // namespace

double Shell::Intersect(const Ray& ray) const {
  const Eigen::Vector3d offset = ray.origin.cwiseQuotient(semi_axes);
  const Eigen::Vector3d direction = ray.direction.cwiseQuotient(semi_axes);
  const double q2 = direction.squaredNorm();
  const double q1 = offset.dot(direction);
  const double discriminant = q1 * q1 - q2 * (offset.squaredNorm() - 1.0);
  if (discriminant < 0.0) return kNone;
  const double t = (-q1 + std::sqrt(discriminant)) / q2;
  return t >= 0.0 ? t : kNone;
}

Eigen::Vector3d Shell::NormalAt(const Eigen::Vector3d& point) const {
  return -point.cwiseQuotient(semi_axes.cwiseAbs2()).normalized();
}

World::World(HeightGrid ground, std::vector<Rock> rocks, std::optional<Shell> shell)
    : ground_(std::move(ground)), rocks_(std::move(rocks)), shell_(shell) {
  num_blocks_x_ = (ground_.num_cells_x() + kBlockCells - 1) / kBlockCells;
  num_blocks_y_ = (ground_.num_cells_y() + kBlockCells - 1) / kBlockCells;
  blocks_.resize(static_cast<std::size_t>(num_blocks_x_ * num_blocks_y_));
  IndexGround();
  IndexRocks();
  for (const Block& block : blocks_) top_ = std::max(top_, block.top);
}

void World::IndexGround() {
  for (int by = 0; by < num_blocks_y_; ++by) {
    for (int bx = 0; bx < num_blocks_x_; ++bx) {
      const int last_row = std::min((by + 1) * kBlockCells, ground_.heights.rows - 1);
      const int last_col = std::min((bx + 1) * kBlockCells, ground_.heights.cols - 1);
      for (int row = by * kBlockCells; row <= last_row; ++row) {
        for (int col = bx * kBlockCells; col <= last_col; ++col) {
          const auto height = static_cast<double>(ground_.heights(row, col));
          if (std::isnan(height)) continue;
          BlockAt(bx, by).top = std::max(BlockAt(bx, by).top, height);
          bottom_ = std::min(bottom_, height);
        }
      }
    }
  }
}

Eigen::Vector2i World::BlockOf(double x, double y) const {
  const double size = ground_.cell * kBlockCells;
  return {std::clamp(static_cast<int>(std::floor((x - ground_.x_min) / size)), 0, num_blocks_x_ - 1),
          std::clamp(static_cast<int>(std::floor((y - ground_.y_min) / size)), 0, num_blocks_y_ - 1)};
}

// Two passes over the rocks: count per block, then fill.
void World::IndexRocks() {
  const auto for_each_block = [&](const Rock& rock, const auto& visit) {
    const Eigen::Vector2i low = BlockOf(rock.centre.x() - rock.half_extent.x(), rock.centre.y() - rock.half_extent.y());
    const Eigen::Vector2i high =
        BlockOf(rock.centre.x() + rock.half_extent.x(), rock.centre.y() + rock.half_extent.y());
    for (int by = low.y(); by <= high.y(); ++by) {
      for (int bx = low.x(); bx <= high.x(); ++bx) visit(BlockAt(bx, by));
    }
  };
  for (const Rock& rock : rocks_) {
    for_each_block(rock, [&](Block& block) {
      ++block.num_rocks;
      block.top = std::max(block.top, rock.centre.z() + rock.half_extent.z());
    });
    bottom_ = std::min(bottom_, rock.centre.z() - rock.half_extent.z());
  }
  int total = 0;
  for (Block& block : blocks_) {
    block.first_rock = total;
    total += std::exchange(block.num_rocks, 0);
  }
  rocks_of_blocks_.resize(static_cast<std::size_t>(total));
  for (std::size_t i = 0; i < rocks_.size(); ++i) {
    for_each_block(rocks_[i], [&](Block& block) {
      rocks_of_blocks_[static_cast<std::size_t>(block.first_rock + block.num_rocks++)] = static_cast<int>(i);
    });
  }
}

Hit World::CastOnGround(const Ray& ray, double max_range) const {
  double t_begin = 0.0;
  double t_end = max_range;
  ClipToSlab(ray.origin.x(), ray.direction.x(), ground_.x_min, ground_.x_max(), &t_begin, &t_end);
  ClipToSlab(ray.origin.y(), ray.direction.y(), ground_.y_min, ground_.y_max(), &t_begin, &t_end);
  ClipToSlab(ray.origin.z(), ray.direction.z(), bottom_ - 1.0, top_ + 1.0, &t_begin, &t_end);
  if (!(t_begin <= t_end)) return {};
  const double size = ground_.cell * kBlockCells;
  const GridLine line = {.x = (ray.origin.x() - ground_.x_min) / size,
                         .y = (ray.origin.y() - ground_.y_min) / size,
                         .dx = ray.direction.x() / size,
                         .dy = ray.direction.y() / size};
  for (GridWalk walk(line, t_begin, t_end, num_blocks_x_, num_blocks_y_); !walk.Done(); walk.Next()) {
    const Block& block = BlockAt(walk.ix(), walk.iy());
    const double t_lowest = ray.direction.z() < 0.0 ? walk.t_out() : walk.t_in();
    if (ray.origin.z() + t_lowest * ray.direction.z() > block.top) continue;
    Hit hit;
    hit.range = ground_.Intersect(ray, walk.t_in(), walk.t_out());
    if (hit.range != kNone) hit.surface = Surface::kGround;
    const Rock* rock_hit = nullptr;
    for (int i = 0; i < block.num_rocks; ++i) {
      const Rock& rock =
          rocks_[static_cast<std::size_t>(rocks_of_blocks_[static_cast<std::size_t>(block.first_rock + i)])];
      const double t = rock.Intersect(ray);
      // Beyond this block something else may come first: the rock is listed in its next block, too.
      if (t < hit.range && t <= walk.t_out()) {
        hit = {.surface = Surface::kRock, .range = t};
        rock_hit = &rock;
      }
    }
    if (hit.surface == Surface::kNothing) continue;
    const Eigen::Vector3d point = ray.origin + hit.range * ray.direction;
    hit.normal = rock_hit != nullptr ? rock_hit->NormalAt(point) : ground_.NormalAt(point.x(), point.y());
    return hit;
  }
  return {};
}

Hit World::CastRay(const Ray& ray, double max_range) const {
  Hit hit = CastOnGround(ray, max_range);
  if (!shell_.has_value()) return hit;
  const double t = shell_->Intersect(ray);
  if (t < hit.range && t <= max_range) {
    hit = {.surface = Surface::kShell, .range = t, .normal = shell_->NormalAt(ray.origin + t * ray.direction)};
  }
  return hit;
}

double World::SurfaceHeight(double x, double y) const {
  double height = ground_.HeightAt(x, y);
  if (std::isnan(height)) return height;
  const Ray down = {.origin = {x, y, top_ + 1.0}, .direction = -Eigen::Vector3d::UnitZ()};
  const Eigen::Vector2i at = BlockOf(x, y);
  const Block& block = BlockAt(at.x(), at.y());
  for (int i = 0; i < block.num_rocks; ++i) {
    const auto index = static_cast<std::size_t>(rocks_of_blocks_[static_cast<std::size_t>(block.first_rock + i)]);
    height = std::max(height, down.origin.z() - rocks_[index].Intersect(down));
  }
  return height;
}

bool World::IsClearOfRocks(const Eigen::Vector2d& place, double radius, double min_height) const {
  return std::none_of(rocks_.begin(), rocks_.end(), [&](const Rock& rock) {
    const double reach = radius + std::max(rock.half_extent.x(), rock.half_extent.y());
    if ((rock.centre.head<2>() - place).squaredNorm() > reach * reach) return false;
    return rock.centre.z() + rock.half_extent.z() - ground_.HeightAt(rock.centre.x(), rock.centre.y()) > min_height;
  });
}

}  // namespace curvereg::sim
