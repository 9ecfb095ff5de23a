// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Cubic cells of the map frame, numbered along Morton's curve [G. M. Morton, "A computer oriented geodetic data base",
// IBM, 1966]: the bits of the three indices interleaved. A run of keys is a compact piece of the ground, and the cells
// of an aligned cube of 2^k cells per edge (a tile) are the keys with the same upper bits.
// Cell faces lie at whole multiples of the edge, so a cell of 0.2 m is made of eight of 0.1 m.
#ifndef CURVEREG_CORE_MAPPING_CELL_GRID_H_
#define CURVEREG_CORE_MAPPING_CELL_GRID_H_

#include <Eigen/Core>
#include <cstdint>

namespace curvereg {

// A point as its cell sees it.
struct PlacedPoint {
  uint64_t key = 0;
  Eigen::Vector3f offset = Eigen::Vector3f::Zero();  // from the cell's centre, in cells: -0.5 to 0.5
};

class CellGrid {
 public:
  static constexpr int kBitsPerAxis = 21;
  static constexpr uint64_t kEndKey = uint64_t{1} << (3 * kBitsPerAxis);  // beyond all keys

  // Reaches 2^20 cells from `middle` [m, map frame] along each axis: 105 km at 0.1 m.
  CellGrid(double cell_m, const Eigen::Vector3d& middle)
      : cell_m_(cell_m),
        cells_per_m_(1.0 / cell_m),
        first_((middle * cells_per_m_).array().floor().matrix() - Eigen::Vector3d::Constant(kReach)) {}

  double cell_m() const { return cell_m_; }

  // False for points that are not finite or beyond the grid's reach.
  bool Place(const Eigen::Vector3d& point_map, PlacedPoint* placed) const {
    const Eigen::Vector3d position = point_map * cells_per_m_ - first_;  // in cells; whole numbers stay exact
    // Coefficient by coefficient: those that are not a number must fail.
    if (!((position.array() >= 0.0).all() && (position.array() < 2.0 * kReach).all())) return false;
    const Eigen::Matrix<int64_t, 3, 1> index = position.cast<int64_t>();
    placed->key = Spread(index.x()) << 2 | Spread(index.y()) << 1 | Spread(index.z());
    placed->offset = (position - index.cast<double>()).cast<float>().array() - 0.5F;
    return true;
  }

  // Coordinates of the cell's low corner in cells, from the map frame's origin: whole numbers.
  Eigen::Vector3d IndexOf(uint64_t key) const {
    return Eigen::Vector3d(Gather(key >> 2), Gather(key >> 1), Gather(key)) + first_;
  }
  // Centre of the tile of 2^level cells per edge that holds the cell [m, map frame]; level 0: of the cell itself.
  Eigen::Vector3d Centre(uint64_t key, int level = 0) const {
    const Eigen::Vector3d low = IndexOf(key >> (3 * level) << (3 * level));
    return (low.array() + 0.5 * (1 << level)) * cell_m_;
  }

 private:
  static constexpr double kReach = 1 << (kBitsPerAxis - 1);

  // Bit i to bit 3 i.
  static uint64_t Spread(int64_t index) {
    auto bits = static_cast<uint64_t>(index);
    bits = (bits | bits << 32) & 0x001f00000000ffff;
    bits = (bits | bits << 16) & 0x001f0000ff0000ff;
    bits = (bits | bits << 8) & 0x100f00f00f00f00f;
    bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
    return (bits | bits << 2) & 0x1249249249249249;
  }
  // Bit 3 i to bit i; others are ignored.
  static double Gather(uint64_t bits) {
    bits &= 0x1249249249249249;
    bits = (bits | bits >> 2) & 0x10c30c30c30c30c3;
    bits = (bits | bits >> 4) & 0x100f00f00f00f00f;
    bits = (bits | bits >> 8) & 0x001f0000ff0000ff;
    bits = (bits | bits >> 16) & 0x001f00000000ffff;
    bits = (bits | bits >> 32) & 0x00000000001fffff;
    return static_cast<double>(bits);
  }

  double cell_m_;
  double cells_per_m_;
  Eigen::Vector3d first_;  // indices of the first cell, whole numbers
};

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_CELL_GRID_H_
