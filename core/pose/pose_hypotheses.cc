// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pose/pose_hypotheses.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/base/parallel.h"

namespace curvereg {
namespace {

// Median of target height minus source height over the agreeing matches.
double HeightShiftOfMatches(const ViewFeatures& source, const ViewFeatures& target, const std::vector<Match>& matches,
                            const PlanarHypothesis& hypothesis) {
  std::vector<double> shifts;
  for (const int index : hypothesis.inliers) {
    const Match& match = matches[static_cast<size_t>(index)];
    shifts.push_back(target.heights_m[static_cast<size_t>(match.target)] -
                     source.heights_m[static_cast<size_t>(match.source)]);
  }
  const auto middle = shifts.begin() + static_cast<std::ptrdiff_t>(shifts.size() / 2);
  std::nth_element(shifts.begin(), middle, shifts.end());
  return *middle;
}

// Shift by whole slices under which most occupied slices coincide, refined between slices by a parabola.
double HeightShiftOfSlices(const OccupancySlices& source, const OccupancySlices& target,
                           const PlanarHypothesis& hypothesis) {
  constexpr int kReach = 8;  // 4 m
  constexpr int kStride = 2;
  const double cosine = std::cos(hypothesis.yaw_rad);
  const double sine = std::sin(hypothesis.yaw_rad);
  const double half = 0.5 * source.slices.cols - 0.5;
  const double shift_col = hypothesis.shift.x() / source.cell_m;
  const double shift_row = hypothesis.shift.y() / source.cell_m;
  std::array<double, 2 * kReach + 1> common{};
  for (int row = 0; row < source.slices.rows; row += kStride) {
    for (int col = 0; col < source.slices.cols; col += kStride) {
      const uint64_t bits = source.slices(row, col);
      if (bits == 0) continue;
      const double x = col - half, y = row - half;
      const int target_col = static_cast<int>(std::lround(cosine * x - sine * y + shift_col + half));
      const int target_row = static_cast<int>(std::lround(sine * x + cosine * y + shift_row + half));
      if (!target.slices.Contains(target_row, target_col)) continue;
      const uint64_t others = target.slices(target_row, target_col);
      if (others == 0) continue;
      for (int k = -kReach; k <= kReach; ++k) {
        const uint64_t moved = k >= 0 ? bits << k : bits >> -k;
        common[static_cast<size_t>(k + kReach)] += std::popcount(moved & others);
      }
    }
  }
  const auto best = std::max_element(common.begin(), common.end()) - common.begin();
  double offset = 0.0;
  if (best > 0 && best < 2 * kReach) {
    const double before = common[static_cast<size_t>(best - 1)], after = common[static_cast<size_t>(best + 1)];
    const double curvature = before - 2.0 * common[static_cast<size_t>(best)] + after;
    if (curvature < 0.0) offset = 0.5 * (before - after) / curvature;
  }
  return (static_cast<double>(best) - kReach + offset) * OccupancySlices::kSliceM;
}

}  // namespace

HypothesesFromViews FindPoseHypotheses(const ViewFeatures& source, const ViewFeatures& target,
                                       const ConsensusOptions& options) {
  HypothesesFromViews result;
  const std::vector<Match> matches = MatchMutualNearest(source.features, target.features);
  result.num_matches = static_cast<int>(matches.size());
  const std::vector<PlanarHypothesis> planar = FindPlanarHypotheses(source.planar, target.planar, matches, options);
  result.hypotheses.resize(planar.size());
  const bool has_heights = !source.heights_m.empty() && !target.heights_m.empty();
  ParallelFor(static_cast<int>(planar.size()), [&](int i) {
    const PlanarHypothesis& hypothesis = planar[static_cast<size_t>(i)];
    const double height = has_heights ? HeightShiftOfMatches(source, target, matches, hypothesis)
                                      : HeightShiftOfSlices(source.slices, target.slices, hypothesis);
    RigidTransform T_level = RigidTransform::Identity();
    T_level.linear() = RotationFromVector({0.0, 0.0, hypothesis.yaw_rad});
    T_level.translation() << hypothesis.shift, height;
    PoseHypothesis& pose = result.hypotheses[static_cast<size_t>(i)];
    pose.T_target_source.linear() = target.R_level_sensor.transpose() * T_level.linear() * source.R_level_sensor;
    pose.T_target_source.translation() = target.R_level_sensor.transpose() * T_level.translation();
    pose.num_inliers = static_cast<int>(hypothesis.inliers.size());
  });
  return result;
}

}  // namespace curvereg
