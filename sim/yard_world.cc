// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/yard_world.h"

#include <numbers>
#include <utility>
#include <vector>

#include "core/base/parallel.h"
#include "sim/landforms.h"
#include "sim/random.h"

namespace curvereg::sim {
namespace {

struct YardForms {
  std::vector<Hill> hills;
  std::vector<Ridge> ridges;
  std::vector<Crater> craters;

  double HeightAt(const Eigen::Vector2d& place) const {
    double height = 0.0;
    for (const Hill& hill : hills) height += hill.HeightAt(place);
    for (const Ridge& ridge : ridges) height += ridge.HeightAt(place);
    for (const Crater& crater : craters) height += crater.HeightAt(place);
    return height;
  }
};

Eigen::Vector2d RandomPlace(const YardOptions& options, double margin, RandomStream& random) {
  const double x = random.Uniform(-0.5, 0.5) * (options.length_m - 2.0 * margin);
  const double y = random.Uniform(-0.5, 0.5) * (options.width_m - 2.0 * margin);
  return {x, y};
}

YardForms RandomForms(const YardOptions& options, uint64_t key) {
  YardForms forms;
  RandomStream random(key);
  for (int i = 0; i < options.num_hills; ++i) {
    const double height = options.max_hill_height_m * random.Uniform(0.35, 1.0);
    // At most 0.6 * height / sigma of slope: a rover can drive over it.
    const double sigma = height * random.Uniform(3.2, 5.5);
    forms.hills.push_back({.centre = RandomPlace(options, 0.0, random), .sigma_m = sigma, .height_m = height});
  }
  for (int i = 0; i < options.num_ridges; ++i) {
    const double height = options.max_ridge_height_m * random.Uniform(0.4, 1.0);
    forms.ridges.push_back({.centre = RandomPlace(options, 4.0, random),
                            .direction_rad = random.Uniform(0.0, std::numbers::pi),
                            .half_length_m = random.Uniform(6.0, 16.0),
                            .bend_m = random.Uniform(-4.0, 4.0),
                            .sigma_m = height * random.Uniform(2.2, 3.6),
                            .height_m = height});
  }
  for (int i = 0; i < options.num_craters; ++i) {
    const double radius = options.max_crater_radius_m * random.Uniform(0.6, 1.0);
    forms.craters.push_back({.centre = RandomPlace(options, options.max_crater_radius_m, random),
                             .radius_m = radius,
                             .depth_m = 0.12 * radius,
                             .rim_m = 0.04 * radius});
  }
  return forms;
}

}  // namespace

World MakeYardWorld(const YardOptions& options, double relief, uint64_t key) {
  HeightGrid grid = MakeHeightGrid(options.length_m, options.width_m, options.cell_m);
  const YardForms forms = RandomForms(options, SubKey(key, 0));
  const uint64_t undulation_key = SubKey(key, 1);
  AddGravel(options.gravel_m, SubKey(key, 2), &grid);
  ParallelFor(grid.heights.rows, [&](int row) {
    const double y = grid.y_min + grid.cell * row;
    for (int col = 0; col < grid.heights.cols; ++col) {
      const double x = grid.x_min + grid.cell * col;
      const double height = forms.HeightAt({x, y}) + FractalNoise(x, y, options.undulation, undulation_key) +
                            static_cast<double>(grid.heights(row, col));
      grid.heights(row, col) = static_cast<float>(relief * height);
    }
  });
  std::vector<Rock> rocks = ScatterRocks(grid, options.rocks, relief, SubKey(key, 3));
  return World(std::move(grid), std::move(rocks));
}

}  // namespace curvereg::sim
