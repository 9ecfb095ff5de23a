// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Ground as a grid of heights with bilinear patches between the vertices: a continuous surface that a ray meets at the
// root of a quadratic, so that the truth of a simulated range is exact.
#ifndef CURVEREG_SIM_HEIGHT_GRID_H_
#define CURVEREG_SIM_HEIGHT_GRID_H_

#include <Eigen/Core>
#include <cstdint>

#include "core/base/image.h"

namespace curvereg::sim {

// Points origin + t * direction, t >= 0. With a direction of length 1, t is the range [m].
struct Ray {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();
};

// Vertex (row, col) stands at (x_min + col * cell, y_min + row * cell). World frame, z up, metres. A height that is
// not a number is a hole: the four patches around it do not exist.
struct HeightGrid {
  double x_min = 0.0;
  double y_min = 0.0;
  double cell = 0.25;
  Image<float> heights;  // rows along y, columns along x; at least 2 x 2

  double x_max() const { return x_min + cell * (heights.cols - 1); }
  double y_max() const { return y_min + cell * (heights.rows - 1); }
  int num_cells_x() const { return heights.cols - 1; }
  int num_cells_y() const { return heights.rows - 1; }

  // Height of the surface at (x, y); NaN outside of the grid and in holes.
  double HeightAt(double x, double y) const;
  // Upward unit normal at (x, y); NaN outside of the grid and in holes.
  Eigen::Vector3d NormalAt(double x, double y) const;
  // Smallest t in [t_begin, t_end] at which the ray meets the patches of the cells it crosses; infinity if none.
  double Intersect(const Ray& ray, double t_begin, double t_end) const;
};

// A grid of heights zero centred on the origin; sizes are rounded up to whole cells.
HeightGrid MakeHeightGrid(double size_x_m, double size_y_m, double cell_m);

}  // namespace curvereg::sim

#endif  // CURVEREG_SIM_HEIGHT_GRID_H_
