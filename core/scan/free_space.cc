// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/scan/free_space.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace curvereg {
FreeSpace::FreeSpace(const std::vector<Eigen::Vector3f>& points, const FreeSpaceOptions& options, const Stop& stop)
    : options_(options) {
  // A scanner sees about a third of the sphere.
  const double wanted = std::sqrt(static_cast<double>(points.size()) / (2.0 * options.points_per_bin));
  cube_.side = std::clamp(static_cast<int>(wanted), 8, options.max_bins_per_side);
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const auto num_bins = static_cast<size_t>(cube_.num_bins());
  std::vector<Interval> single(num_bins, Interval{kInfinity, -kInfinity, false});
  constexpr size_t kPointsPerQuestion = 65536;
  for (size_t i = 0; i < points.size(); ++i) {
    if (i % kPointsPerQuestion == 0 && stop.Requested()) break;
    const Eigen::Vector3f& point = points[i];
    const float range = point.norm();
    if (!(range > 0.0F && range < kInfinity)) continue;
    Interval& bin = single[static_cast<size_t>(cube_.BinOf(point))];
    bin.nearest = std::min(bin.nearest, range);
    bin.farthest = std::max(bin.farthest, range);
  }
  bins_.assign(num_bins, Interval{kInfinity, -kInfinity, false});
  for (size_t i = 0; i < num_bins; ++i) {
    bins_[i].measured = single[i].nearest <= single[i].farthest;
    cube_.ForNeighbours(static_cast<int>(i), [&](int neighbour) {
      const Interval& other = single[static_cast<size_t>(neighbour)];
      bins_[i].nearest = std::min(bins_[i].nearest, other.nearest);
      bins_[i].farthest = std::max(bins_[i].farthest, other.farthest);
    });
  }
}

FreeSpace::Answer FreeSpace::Ask(const Eigen::Vector3f& point) const {
  const float range = point.norm();
  if (bins_.empty() || !(range > 0.0F) || !std::isfinite(range)) return Answer::kUnseen;
  const Interval& bin = bins_[static_cast<size_t>(cube_.BinOf(point))];
  if (bin.nearest > bin.farthest) return Answer::kUnseen;
  const float margin = static_cast<float>(options_.margin_m) + static_cast<float>(options_.margin_per_metre) * range;
  if (range < bin.nearest - margin) return bin.measured ? Answer::kViolates : Answer::kUnseen;
  if (range > bin.farthest + margin) return Answer::kUnseen;
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
      case FreeSpace::Answer::kUnseen:
        ++agreement.unknown;
        break;
    }
  }
  return agreement;
}

}  // namespace curvereg
