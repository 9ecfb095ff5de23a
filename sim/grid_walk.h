// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The cells of a square grid that a ray crosses seen from above, in order, each with its span of t.
// [Amanatides and Woo, "A fast voxel traversal algorithm for ray tracing", 1987]
#ifndef CURVEREG_SIM_GRID_WALK_H_
#define CURVEREG_SIM_GRID_WALK_H_

#include <algorithm>
#include <cmath>
#include <limits>

namespace curvereg::sim {

// Position and velocity of a ray in units of cells: cell (i, j) covers [i, i + 1) x [j, j + 1).
struct GridLine {
  double x = 0.0;
  double y = 0.0;
  double dx = 0.0;
  double dy = 0.0;
};

class GridWalk {
 public:
  // Walks t from t_begin to t_end over num_x by num_y cells; the line is inside of the grid at t_begin.
  GridWalk(const GridLine& line, double t_begin, double t_end, int num_x, int num_y)
      : line_(line), num_x_(num_x), num_y_(num_y), t_in_(t_begin), t_end_(t_end) {
    ix_ = std::clamp(static_cast<int>(std::floor(line.x + t_begin * line.dx)), 0, num_x - 1);
    iy_ = std::clamp(static_cast<int>(std::floor(line.y + t_begin * line.dy)), 0, num_y - 1);
    step_x_ = line.dx > 0.0 ? 1 : -1;
    step_y_ = line.dy > 0.0 ? 1 : -1;
    inverse_dx_ = line.dx == 0.0 ? 0.0 : 1.0 / line.dx;
    inverse_dy_ = line.dy == 0.0 ? 0.0 : 1.0 / line.dy;
    UpdateX();
    UpdateY();
  }

  bool Done() const { return done_; }
  int ix() const { return ix_; }
  int iy() const { return iy_; }
  double t_in() const { return t_in_; }
  double t_out() const { return std::min({t_x_, t_y_, t_end_}); }

  void Next() {
    const double t_next = std::min(t_x_, t_y_);
    if (t_next >= t_end_) {
      done_ = true;
      return;
    }
    if (t_x_ <= t_y_) {
      ix_ += step_x_;
      UpdateX();
    } else {
      iy_ += step_y_;
      UpdateY();
    }
    t_in_ = std::max(t_in_, t_next);
    done_ = ix_ < 0 || iy_ < 0 || ix_ >= num_x_ || iy_ >= num_y_;
  }

 private:
  // Crossings are computed from the cell's index, not summed, so they carry no rounding from cell to cell.
  void UpdateX() {
    t_x_ = line_.dx == 0.0 ? std::numeric_limits<double>::infinity()
                           : (ix_ + (step_x_ > 0 ? 1 : 0) - line_.x) * inverse_dx_;
  }
  void UpdateY() {
    t_y_ = line_.dy == 0.0 ? std::numeric_limits<double>::infinity()
                           : (iy_ + (step_y_ > 0 ? 1 : 0) - line_.y) * inverse_dy_;
  }

  GridLine line_;
  int num_x_;
  int num_y_;
  int ix_ = 0;
  int iy_ = 0;
  int step_x_ = 1;
  int step_y_ = 1;
  double inverse_dx_ = 0.0;
  double inverse_dy_ = 0.0;
  double t_x_ = 0.0;
  double t_y_ = 0.0;
  double t_in_;
  double t_end_;
  bool done_ = false;
};

}  // namespace curvereg::sim

#endif  // CURVEREG_SIM_GRID_WALK_H_
