// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/height_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/grid_walk.h"

namespace curvereg::sim {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// h(u, v) = h00 + a u + b v + c u v for u, v in [0, 1] across one cell.
struct Patch {
  double h00 = kNan;
  double a = 0.0;
  double b = 0.0;
  double c = 0.0;
  double top = 0.0;  // largest height of the patch
};

Patch PatchAt(const Image<float>& heights, int ix, int iy) {
  const float* low = heights.Row(iy) + ix;
  const float* high = heights.Row(iy + 1) + ix;
  const auto h00 = static_cast<double>(low[0]);
  const auto h10 = static_cast<double>(low[1]);
  const auto h01 = static_cast<double>(high[0]);
  const auto h11 = static_cast<double>(high[1]);
  return {.h00 = h00,
          .a = h10 - h00,
          .b = h01 - h00,
          .c = h00 + h11 - h10 - h01,
          .top = std::max(std::max(h00, h10), std::max(h01, h11))};
}

// Smallest root in [low, high] of q2 s^2 + q1 s + q0, or infinity. The form without cancellation.
double SmallestRoot(double q2, double q1, double q0, double low, double high) {
  const double discriminant = q1 * q1 - 4.0 * q2 * q0;
  if (!(discriminant >= 0.0)) return kNone;
  const double half = -0.5 * (q1 + std::copysign(std::sqrt(discriminant), q1));
  double first = half == 0.0 ? kNone : q0 / half;
  double second = q2 == 0.0 ? kNone : half / q2;
  if (half == 0.0 && q0 == 0.0) first = 0.0;
  if (second < first) std::swap(first, second);
  if (first >= low && first <= high) return first;
  return second >= low && second <= high ? second : kNone;
}

struct CellPosition {
  int ix = 0;
  int iy = 0;
  double u = 0.0;
  double v = 0.0;
  bool inside = false;
};

CellPosition Locate(const HeightGrid& grid, double x, double y) {
  const double gx = (x - grid.x_min) / grid.cell;
  const double gy = (y - grid.y_min) / grid.cell;
  if (!(gx >= 0.0 && gy >= 0.0 && gx <= grid.num_cells_x() && gy <= grid.num_cells_y())) return {};
  const int ix = std::min(static_cast<int>(gx), grid.num_cells_x() - 1);
  const int iy = std::min(static_cast<int>(gy), grid.num_cells_y() - 1);
  return {.ix = ix, .iy = iy, .u = gx - ix, .v = gy - iy, .inside = true};
}

}  // namespace

double HeightGrid::HeightAt(double x, double y) const {
  const CellPosition at = Locate(*this, x, y);
  if (!at.inside) return kNan;
  const Patch patch = PatchAt(heights, at.ix, at.iy);
  return patch.h00 + patch.a * at.u + patch.b * at.v + patch.c * at.u * at.v;
}

Eigen::Vector3d HeightGrid::NormalAt(double x, double y) const {
  const CellPosition at = Locate(*this, x, y);
  if (!at.inside) return Eigen::Vector3d::Constant(kNan);
  const Patch patch = PatchAt(heights, at.ix, at.iy);
  const double slope_x = (patch.a + patch.c * at.v) / cell;
  const double slope_y = (patch.b + patch.c * at.u) / cell;
  return Eigen::Vector3d(-slope_x, -slope_y, 1.0).normalized();
}

double HeightGrid::Intersect(const Ray& ray, double t_begin, double t_end) const {
  const GridLine line = {.x = (ray.origin.x() - x_min) / cell,
                         .y = (ray.origin.y() - y_min) / cell,
                         .dx = ray.direction.x() / cell,
                         .dy = ray.direction.y() / cell};
  const double dz = ray.direction.z();
  for (GridWalk walk(line, t_begin, t_end, num_cells_x(), num_cells_y()); !walk.Done(); walk.Next()) {
    const double t_in = walk.t_in();
    const double t_out = walk.t_out();
    const Patch patch = PatchAt(heights, walk.ix(), walk.iy());
    const double z_in = ray.origin.z() + t_in * dz;
    const double lowest = std::min(z_in, ray.origin.z() + t_out * dz);
    if (lowest > patch.top || std::isnan(patch.c)) continue;
    // With s = t - t_in: z - h = q2 s^2 + q1 s + q0.
    const double u = line.x + t_in * line.dx - walk.ix();
    const double v = line.y + t_in * line.dy - walk.iy();
    const double q0 = z_in - patch.h00 - patch.a * u - patch.b * v - patch.c * u * v;
    const double q1 = dz - patch.a * line.dx - patch.b * line.dy - patch.c * (u * line.dy + v * line.dx);
    const double q2 = -patch.c * line.dx * line.dy;
    // The slack closes the seam between neighbouring cells against rounding.
    constexpr double kSlack = 1e-9;
    const double root = SmallestRoot(q2, q1, q0, -kSlack, t_out - t_in + kSlack);
    if (root != kNone) return t_in + root;
  }
  return kNone;
}

HeightGrid MakeHeightGrid(double size_x_m, double size_y_m, double cell_m) {
  HeightGrid grid;
  const int cells_x = std::max(1, static_cast<int>(std::ceil(size_x_m / cell_m - 1e-9)));
  const int cells_y = std::max(1, static_cast<int>(std::ceil(size_y_m / cell_m - 1e-9)));
  grid.cell = cell_m;
  grid.x_min = -0.5 * cell_m * cells_x;
  grid.y_min = -0.5 * cell_m * cells_y;
  grid.heights = Image<float>(cells_y + 1, cells_x + 1, 0.0F);
  return grid;
}

}  // namespace curvereg::sim
