// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/dome_world.h"

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "sim/landforms.h"
#include "sim/random.h"

namespace curvereg::sim {
namespace {

Eigen::Vector2d Polar(double radius, double angle) { return {radius * std::cos(angle), radius * std::sin(angle)}; }

}  // namespace

World MakeDomeWorld(const DomeOptions& options, double relief, uint64_t key) {
  const double radius = 0.5 * options.diameter_m;
  HeightGrid grid = MakeHeightGrid(options.diameter_m, options.diameter_m, options.cell_m);
  RandomStream random(SubKey(key, 0));
  // Basin and ridge on opposite sides, so that each scan sees both.
  const double basin_direction = random.Uniform(0.0, 2.0 * std::numbers::pi);
  const double basin_radius = radius * random.Uniform(0.2, 0.28);
  const Crater basin = {.centre = Polar(radius * random.Uniform(0.4, 0.55), basin_direction),
                        .radius_m = basin_radius,
                        .depth_m = 0.12 * basin_radius,
                        .rim_m = 0.05 * basin_radius};
  const Ridge ridge = {.centre = Polar(radius * random.Uniform(0.5, 0.65), basin_direction + std::numbers::pi),
                       .direction_rad = basin_direction + random.Uniform(1.0, 2.1),
                       .half_length_m = radius * random.Uniform(0.25, 0.4),
                       .bend_m = random.Uniform(-1.5, 1.5),
                       .sigma_m = random.Uniform(1.2, 1.8),
                       .height_m = random.Uniform(0.6, 1.0)};
  std::vector<Hill> mounds;
  for (int i = 0; i < options.num_mounds; ++i) {
    const double height = random.Uniform(0.3, 0.9);
    mounds.push_back({.centre = Polar(radius * std::sqrt(random.Uniform(0.1, 0.9)), random.Uniform(0.0, 6.3)),
                      .sigma_m = height * random.Uniform(3.0, 4.5),
                      .height_m = height});
  }
  AddGravel(options.gravel_m, SubKey(key, 2), &grid);
  for (int row = 0; row < grid.heights.rows; ++row) {
    const double y = grid.y_min + grid.cell * row;
    for (int col = 0; col < grid.heights.cols; ++col) {
      const double x = grid.x_min + grid.cell * col;
      double height = FractalNoise(x, y, options.undulation, SubKey(key, 1)) + basin.HeightAt({x, y}) +
                      ridge.HeightAt({x, y}) + static_cast<double>(grid.heights(row, col));
      for (const Hill& mound : mounds) height += mound.HeightAt({x, y});
      grid.heights(row, col) = static_cast<float>(relief * height);
    }
  }
  std::vector<Rock> rocks = ScatterRocks(grid, options.rocks, relief, SubKey(key, 3));
  return World(std::move(grid), std::move(rocks), Shell{.semi_axes = {radius, radius, options.height_m}});
}

}  // namespace curvereg::sim
