// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pose/rigid_fit.h"

#include <cmath>

#include "core/base/small_matrices.h"

namespace curvereg {
namespace {

constexpr double kRankTolerance = 1e-9;

PointPair MeanOf(std::span<const PointPair> pairs) {
  PointPair mean;
  for (const PointPair& pair : pairs) {
    mean.source += pair.source;
    mean.target += pair.target;
  }
  mean.source /= static_cast<double>(pairs.size());
  mean.target /= static_cast<double>(pairs.size());
  return mean;
}

}  // namespace

absl::StatusOr<RigidTransform> FitRigidTransform(std::span<const PointPair> pairs) {
  if (pairs.size() < 3) return absl::InvalidArgumentError("rigid fit: fewer than three pairs of points");
  const PointPair mean = MeanOf(pairs);
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();  // cross-covariance, target from source
  double source_spread = 0.0;
  double target_spread = 0.0;
  for (const PointPair& pair : pairs) {
    const Eigen::Vector3d source = pair.source - mean.source;
    const Eigen::Vector3d target = pair.target - mean.target;
    H.noalias() += target * source.transpose();
    source_spread += source.squaredNorm();
    target_spread += target.squaredNorm();
  }
  if (!H.allFinite() || !std::isfinite(source_spread) || !std::isfinite(target_spread)) {
    return absl::InvalidArgumentError("rigid fit: a coordinate is not finite");
  }
  const SingularValues svd = SingularValuesOf(H);
  // Two singular values above zero determine the rotation: the third axis follows from the right-hand rule.
  if (svd.values[1] <= kRankTolerance * std::sqrt(source_spread * target_spread)) {
    return absl::FailedPreconditionError("rigid fit: the points are equal or on one line");
  }
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  if (svd.U.determinant() * svd.V.determinant() < 0.0) signs[2] = -1.0;
  RigidTransform T_target_source = RigidTransform::Identity();
  T_target_source.linear() = svd.U * signs.asDiagonal() * svd.V.transpose();
  T_target_source.translation() = mean.target - T_target_source.linear() * mean.source;
  return T_target_source;
}

}  // namespace curvereg
