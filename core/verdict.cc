// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/verdict.h"

#include <algorithm>
#include <cmath>

namespace curvereg {

PoseCheck CheckPose(const PreparedScan& source, const PreparedScan& target, const RigidTransform& T_target_source) {
  const FreeSpaceAgreement of_source = AskAll(target.free_space(), T_target_source, source.representatives());
  const FreeSpaceAgreement of_target = AskAll(source.free_space(), T_target_source.inverse(), target.representatives());
  PoseCheck check;
  check.free_space_agreement = std::min(of_source.Agreement(), of_target.Agreement());
  check.overlap_source = of_source.Overlap();
  check.overlap_target = of_target.Overlap();
  check.overlap_points = std::min(of_source.agreeing, of_target.agreeing);
  return check;
}

ViewCorrelation CorrelateViews(const ViewFeatures& source, const ViewFeatures& target,
                               const RigidTransform& T_target_source) {
  constexpr int kStride = 2;
  const Eigen::Matrix3d R = target.R_level_sensor * T_target_source.linear() * source.R_level_sensor.transpose();
  const Eigen::Vector3d t = target.R_level_sensor * T_target_source.translation();
  const Image<float>& a = source.band_pass;
  const Image<float>& b = target.band_pass;
  double n = 0.0, sum_a = 0.0, sum_b = 0.0, sum_aa = 0.0, sum_bb = 0.0, sum_ab = 0.0;
  for (int row = 0; row < a.rows; row += kStride) {
    for (int col = 0; col < a.cols; col += kStride) {
      if (source.valid(row, col) == 0) continue;
      const Eigen::Vector2d from = source.image.PositionOf(row, col);
      const Eigen::Vector2d to = R.topLeftCorner<2, 2>() * from + t.head<2>();
      const Eigen::Vector2d pixel = target.image.PixelOf(to);
      const int target_row = static_cast<int>(std::lround(pixel.x()));
      const int target_col = static_cast<int>(std::lround(pixel.y()));
      if (!b.Contains(target_row, target_col) || target.valid(target_row, target_col) == 0) continue;
      const double value_a = a(row, col);
      const double value_b = b(target_row, target_col);
      n += 1.0;
      sum_a += value_a;
      sum_b += value_b;
      sum_aa += value_a * value_a;
      sum_bb += value_b * value_b;
      sum_ab += value_a * value_b;
    }
  }
  ViewCorrelation correlation;
  correlation.num_pixels = static_cast<int>(n);
  if (n < 2.0) return correlation;
  const double variance_a = sum_aa - sum_a * sum_a / n;
  const double variance_b = sum_bb - sum_b * sum_b / n;
  if (variance_a > 0.0 && variance_b > 0.0) {
    correlation.ncc = (sum_ab - sum_a * sum_b / n) / std::sqrt(variance_a * variance_b);
  }
  return correlation;
}

}  // namespace curvereg
