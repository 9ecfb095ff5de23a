// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Directions from the sensor sorted into bins on the six faces of a cube: nearly even bins at any attitude, no
// trigonometry. Bins are numbered face by face, row by row.
#ifndef CURVEREG_CORE_SCAN_CUBE_MAP_H_
#define CURVEREG_CORE_SCAN_CUBE_MAP_H_

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace curvereg {

struct CubeMap {
  int side = 1;  // bins per side of a face; the widest is 2 / side rad

  int num_bins() const { return 6 * side * side; }

  // Bin of the direction of `point`. Precondition: finite and not the origin.
  int BinOf(const Eigen::Vector3f& point) const {
    const float ax = std::abs(point.x()), ay = std::abs(point.y()), az = std::abs(point.z());
    float major = point.x(), u = point.y(), v = point.z();
    int face = 0;
    if (ay >= ax && ay >= az) {
      major = point.y(), u = point.z(), v = point.x();
      face = 2;
    } else if (az >= ax) {
      major = point.z(), u = point.x(), v = point.y();
      face = 4;
    }
    const float half = 0.5F * static_cast<float>(side);
    const float scale = half / std::abs(major);
    const int col = std::clamp(static_cast<int>(u * scale + half), 0, side - 1);
    const int row = std::clamp(static_cast<int>(v * scale + half), 0, side - 1);
    return ((major < 0.0F ? face + 1 : face) * side + row) * side + col;
  }

  // Calls visit(bin) for the bin and its up to eight neighbours on the same face.
  template <typename Visit>
  void ForNeighbours(int bin, const Visit& visit) const {
    const int face_row = bin / side;
    const int col = bin % side;
    const int row = face_row % side;
    for (int r = std::max(0, row - 1); r <= std::min(side - 1, row + 1); ++r) {
      for (int c = std::max(0, col - 1); c <= std::min(side - 1, col + 1); ++c) {
        visit((face_row - row + r) * side + c);
      }
    }
  }
};

}  // namespace curvereg

#endif  // CURVEREG_CORE_SCAN_CUBE_MAP_H_
