// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/free_space.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace curvereg {
namespace {

struct BinIndex {
  int face, row, col;
};

// Face of the cube that the direction pierces and the bin on it. Precondition: finite and not the origin.
BinIndex BinOf(const Eigen::Vector3f& point, int side) {
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
  const float scale = 0.5F * static_cast<float>(side) / std::abs(major);
  const float half = 0.5F * static_cast<float>(side);
  const int col = std::clamp(static_cast<int>(u * scale + half), 0, side - 1);
  const int row = std::clamp(static_cast<int>(v * scale + half), 0, side - 1);
  return {major < 0.0F ? face + 1 : face, row, col};
}

}  // namespace

FreeSpace::FreeSpace(const std::vector<Eigen::Vector3f>& points, const FreeSpaceOptions& options) : options_(options) {
  // A scanner sees about a third of the sphere.
  const double wanted = std::sqrt(static_cast<double>(points.size()) / (2.0 * options.points_per_bin));
  side_ = std::clamp(static_cast<int>(wanted), 8, options.max_bins_per_side);
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const auto num_bins = static_cast<size_t>(6 * side_ * side_);
  std::vector<Interval> single(num_bins, Interval{kInfinity, -kInfinity});
  for (const Eigen::Vector3f& point : points) {
    const float range = point.norm();
    if (!(range > 0.0F && range < kInfinity)) continue;
    const BinIndex index = BinOf(point, side_);
    Interval& bin = single[static_cast<size_t>((index.face * side_ + index.row) * side_ + index.col)];
    bin.nearest = std::min(bin.nearest, range);
    bin.farthest = std::max(bin.farthest, range);
  }
  bins_.assign(num_bins, Interval{kInfinity, -kInfinity});
  for (int face = 0; face < 6; ++face) {
    for (int row = 0; row < side_; ++row) {
      for (int col = 0; col < side_; ++col) {
        Interval& bin = bins_[static_cast<size_t>((face * side_ + row) * side_ + col)];
        for (int r = std::max(0, row - 1); r <= std::min(side_ - 1, row + 1); ++r) {
          for (int c = std::max(0, col - 1); c <= std::min(side_ - 1, col + 1); ++c) {
            const Interval& other = single[static_cast<size_t>((face * side_ + r) * side_ + c)];
            bin.nearest = std::min(bin.nearest, other.nearest);
            bin.farthest = std::max(bin.farthest, other.farthest);
          }
        }
      }
    }
  }
}

FreeSpace::Answer FreeSpace::Ask(const Eigen::Vector3f& point) const {
  const float range = point.norm();
  if (side_ == 0 || !(range > 0.0F) || !std::isfinite(range)) return Answer::kUnknown;
  const BinIndex index = BinOf(point, side_);
  const Interval& bin = bins_[static_cast<size_t>((index.face * side_ + index.row) * side_ + index.col)];
  if (bin.nearest > bin.farthest) return Answer::kUnknown;
  const float margin = static_cast<float>(options_.margin_m) + static_cast<float>(options_.margin_per_metre) * range;
  if (range < bin.nearest - margin) return Answer::kViolates;
  if (range > bin.farthest + margin) return Answer::kUnknown;
  return Answer::kAgrees;
}

double FreeSpaceAgreement::Agreement() const {
  const int answered = agreeing + violating;
  return answered == 0 ? 0.0 : static_cast<double>(agreeing) / answered;
}

double FreeSpaceAgreement::Overlap() const {
  const int all = agreeing + violating + unknown;
  return all == 0 ? 0.0 : static_cast<double>(agreeing) / all;
}

FreeSpaceAgreement AskAll(const FreeSpace& free_space, const RigidTransform& T_scan_points,
                          const std::vector<Eigen::Vector3f>& points) {
  const Eigen::Matrix3f R = T_scan_points.linear().cast<float>();
  const Eigen::Vector3f t = T_scan_points.translation().cast<float>();
  FreeSpaceAgreement agreement;
  for (const Eigen::Vector3f& point : points) {
    switch (free_space.Ask(R * point + t)) {
      case FreeSpace::Answer::kAgrees:
        ++agreement.agreeing;
        break;
      case FreeSpace::Answer::kViolates:
        ++agreement.violating;
        break;
      case FreeSpace::Answer::kUnknown:
        ++agreement.unknown;
        break;
    }
  }
  return agreement;
}

}  // namespace curvereg
