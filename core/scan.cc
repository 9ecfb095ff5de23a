// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/scan.h"

#include <xxhash.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace curvereg {

absl::Status ValidateScan(const Scan& scan, const ScanLimits& limits) {
  const auto num_points = static_cast<int64_t>(scan.points.size());
  if (num_points > limits.max_points) {
    return absl::InvalidArgumentError(
        absl::StrCat("scan has ", num_points, " points; at most ", limits.max_points, " are allowed"));
  }
  if (scan.gravity.has_value() && (!scan.gravity->allFinite() || scan.gravity->norm() == 0.0)) {
    return absl::InvalidArgumentError("gravity vector is zero or not finite");
  }
  int64_t num_finite = 0;
  const auto limit = static_cast<float>(limits.max_coordinate_m);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& point : scan.points) {
    if (!point.allFinite()) continue;
    if (point.cwiseAbs().maxCoeff() > limit) {
      return absl::InvalidArgumentError(absl::StrFormat("scan has a coordinate beyond %g m; is it in metres?", limit));
    }
    ++num_finite;
    sum += point.cast<double>();
  }
  if (num_finite < limits.min_points) {
    return absl::InvalidArgumentError(
        absl::StrCat("scan has ", num_finite, " finite points; at least ", limits.min_points, " are needed"));
  }
  const Eigen::Vector3d mean = sum / static_cast<double>(num_finite);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3f& point : scan.points) {
    if (!point.allFinite()) continue;
    const Eigen::Vector3d offset = point.cast<double>() - mean;
    covariance.noalias() += offset * offset.transpose();
  }
  covariance /= static_cast<double>(num_finite);
  const Eigen::Vector3d variances =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance, Eigen::EigenvaluesOnly).eigenvalues();
  // A line as float32 has a second variance of its rounding only.
  const double rounding = 1e-12 * (mean.squaredNorm() + variances[2]);
  if (variances[2] <= rounding) return absl::InvalidArgumentError("all points of the scan are equal");
  if (variances[1] <= rounding) return absl::InvalidArgumentError("all points of the scan lie on one line");
  return absl::OkStatus();
}

std::string ScanDigest(const Scan& scan) {
  static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));
  const XXH64_hash_t points_hash = XXH3_64bits(scan.points.data(), scan.points.size() * sizeof(Eigen::Vector3f));
  if (!scan.gravity.has_value()) return absl::StrFormat("%016x", points_hash);
  return absl::StrFormat("%016x", XXH3_64bits_withSeed(scan.gravity->data(), 3 * sizeof(double), points_hash));
}

Scan TransformScan(const Scan& scan, const Eigen::Isometry3d& T_new_old) {
  Scan result;
  result.points.reserve(scan.points.size());
  for (const Eigen::Vector3f& point : scan.points) {
    result.points.push_back((T_new_old * point.cast<double>()).cast<float>());
  }
  if (scan.gravity.has_value()) result.gravity = T_new_old.linear() * *scan.gravity;
  return result;
}

}  // namespace curvereg
