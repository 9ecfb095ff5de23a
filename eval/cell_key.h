// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Cells of a cubic grid, named by one number.
#ifndef CURVEREG_EVAL_CELL_KEY_H_
#define CURVEREG_EVAL_CELL_KEY_H_

#include <Eigen/Core>
#include <cstdint>
#include <optional>

namespace curvereg {

struct GridCell {
  uint64_t key = 0;
  Eigen::Vector3d corner = Eigen::Vector3d::Zero();  // of the least coordinates [m]
};

// The cell of `point` [m]; nullopt when it is farther than a million cells from the origin.
inline std::optional<GridCell> CellOf(const Eigen::Vector3d& point, double cell_m) {
  constexpr double kMaxCell = 1 << 20;  // 21 bits with the sign, so that three fit a 64-bit key
  const Eigen::Vector3d cell = (point / cell_m).array().floor();
  if (!(cell.cwiseAbs().maxCoeff() < kMaxCell)) return std::nullopt;
  uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) key = (key << 21) | static_cast<uint64_t>(cell[axis] + kMaxCell);
  return GridCell{.key = key, .corner = cell * cell_m};
}

}  // namespace curvereg

#endif  // CURVEREG_EVAL_CELL_KEY_H_
