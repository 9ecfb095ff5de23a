// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/surface_thickness.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/base/small_matrices.h"
#include "eval/distribution.h"

namespace curvereg {
namespace {

constexpr int kMinPoints = 5;  // of one scan in a cell: fewer say little about where it saw the surface

}  // namespace

SurfaceThickness::SurfaceThickness(double cell_m) : grid_(cell_m, Eigen::Vector3d::Zero()) { assert(cell_m > 0.0); }

void SurfaceThickness::Add(const Scan& scan, const RigidTransform& T_map_scan) {
  const int number = num_scans_++;
  for (const Eigen::Vector3f& point : scan.points) {
    PlacedPoint placed;
    if (!grid_.Place(T_map_scan * point.cast<double>(), &placed)) continue;
    const auto [entry, is_new] = index_of_.try_emplace(placed.key, cells_.size());
    if (is_new) cells_.emplace_back();
    Cell& cell = cells_[entry->second];
    const Eigen::Vector3d offset = placed.offset.cast<double>() * grid_.cell_m();
    cell.sum += offset;
    cell.sum_of_squares += offset * offset.transpose();
    ++cell.count;
    if (cell.last_scan != number) {
      cell.last_scan = number;
      cell.points_of_last_scan = 0;
    }
    if (++cell.points_of_last_scan == kMinPoints) ++cell.num_scans;
  }
}

SurfaceThickness::Result SurfaceThickness::Measure() const {
  std::vector<double> thickness;
  for (const Cell& cell : cells_) {
    if (cell.num_scans < 2) continue;
    const auto count = static_cast<double>(cell.count);
    const Eigen::Vector3d mean = cell.sum / count;
    const Eigen::Matrix3d covariance = cell.sum_of_squares / count - mean * mean.transpose();
    thickness.push_back(std::sqrt(std::max(EigenvaluesOf(covariance)[0], 0.0)));
  }
  return {.median_m = Quantile(thickness, 0.5),
          .p90_m = Quantile(thickness, 0.9),
          .num_cells = static_cast<int64_t>(thickness.size())};
}

}  // namespace curvereg
