// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/scan.h"

#include <xxhash.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace curvereg {
namespace {

struct PointMoments {
  int64_t num_finite = 0;
  float largest = 0.0F;  // |coordinate| [m]
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

// One pass; sums are taken about the first finite point, which keeps them exact enough far from the origin.
PointMoments MeasurePoints(const std::vector<Eigen::Vector3f>& points, const Stop& stop) {
  constexpr size_t kPointsPerQuestion = 65536;
  PointMoments moments;
  Eigen::Vector3f origin = Eigen::Vector3f::Zero();
  double x = 0.0, y = 0.0, z = 0.0, xx = 0.0, xy = 0.0, xz = 0.0, yy = 0.0, yz = 0.0, zz = 0.0;
  for (size_t i = 0; i < points.size(); ++i) {
    if (i % kPointsPerQuestion == 0 && stop.Requested()) break;
    const Eigen::Vector3f& point = points[i];
    const float sum = point.x() + point.y() + point.z();
    if (!(sum - sum == 0.0F)) continue;  // not finite
    if (moments.num_finite++ == 0) origin = point;
    moments.largest = std::max({moments.largest, std::abs(point.x()), std::abs(point.y()), std::abs(point.z())});
    const double dx = static_cast<double>(point.x()) - origin.x();
    const double dy = static_cast<double>(point.y()) - origin.y();
    const double dz = static_cast<double>(point.z()) - origin.z();
    x += dx, y += dy, z += dz;
    xx += dx * dx, xy += dx * dy, xz += dx * dz, yy += dy * dy, yz += dy * dz, zz += dz * dz;
  }
  if (moments.num_finite == 0) return moments;
  const double n = static_cast<double>(moments.num_finite);
  const Eigen::Vector3d offset = Eigen::Vector3d(x, y, z) / n;
  moments.mean = origin.cast<double>() + offset;
  moments.covariance << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  moments.covariance = moments.covariance / n - offset * offset.transpose();
  return moments;
}

}  // namespace

absl::Status ValidateScan(const Scan& scan, const ScanLimits& limits, const Stop& stop) {
  const auto num_points = static_cast<int64_t>(scan.points.size());
  if (num_points > limits.max_points) {
    return absl::InvalidArgumentError(
        absl::StrCat("scan has ", num_points, " points; at most ", limits.max_points, " are allowed"));
  }
  if (scan.gravity.has_value() && (!scan.gravity->allFinite() || scan.gravity->norm() == 0.0)) {
    return absl::InvalidArgumentError("gravity vector is zero or not finite");
  }
  const PointMoments moments = MeasurePoints(scan.points, stop);
  if (stop.Requested()) return absl::OkStatus();
  if (moments.largest > limits.max_coordinate_m) {
    return absl::InvalidArgumentError(
        absl::StrFormat("scan has a coordinate beyond %g m; is it in metres?", limits.max_coordinate_m));
  }
  if (moments.num_finite < limits.min_points) {
    return absl::InvalidArgumentError(
        absl::StrCat("scan has ", moments.num_finite, " finite points; at least ", limits.min_points, " are needed"));
  }
  const Eigen::Vector3d& mean = moments.mean;
  const Eigen::Vector3d variances =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moments.covariance, Eigen::EigenvaluesOnly).eigenvalues();
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
