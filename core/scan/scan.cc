// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/scan/scan.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/hash.h"
#include "core/base/simd.h"
#include "core/base/small_matrices.h"

namespace curvereg {
namespace {

constexpr size_t kPointsPerQuestion = 65536;

bool IsFinite(const Eigen::Vector3f& point) {
  const Eigen::Vector3f zero = point - point;  // NaN where a coordinate is not finite
  return zero.x() == 0.0F && zero.y() == 0.0F && zero.z() == 0.0F;
}

struct PointCounts {
  int64_t num_finite = 0;
  float largest = 0.0F;  // |coordinate| of the finite points [m]
};

PointCounts CountPoints(const std::vector<Eigen::Vector3f>& points, const Stop& stop) {
  PointCounts counts;
  for (size_t begin = 0; begin < points.size() && !stop.Requested(); begin += kPointsPerQuestion) {
    const size_t end = std::min(points.size(), begin + kPointsPerQuestion);
    for (size_t i = begin; i < end; ++i) {
      if (!IsFinite(points[i])) continue;
      ++counts.num_finite;
      counts.largest =
          std::max({counts.largest, std::abs(points[i].x()), std::abs(points[i].y()), std::abs(points[i].z())});
    }
  }
  return counts;
}

// How the finite ones of every `stride`-th point lie.
enum class Spread { kNone, kLine, kArea };

Spread MeasureSpread(const std::vector<Eigen::Vector3f>& points, size_t stride, const Stop& stop) {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // the first point: sums about it stay exact far from the sensor
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  double n = 0.0;
  for (size_t i = 0; i < points.size(); i += stride) {
    if (i % kPointsPerQuestion == 0 && stop.Requested()) break;
    if (!IsFinite(points[i])) continue;
    if (n == 0.0) origin = points[i].cast<double>();
    const Eigen::Vector3d offset = points[i].cast<double>() - origin;
    n += 1.0;
    sum += offset;
    squares.noalias() += offset * offset.transpose();
  }
  if (n == 0.0) return Spread::kNone;
  const Eigen::Vector3d mean = sum / n;
  const Eigen::Matrix3d covariance = squares / n - mean * mean.transpose();
  const Eigen::Vector3d variances = EigenvaluesOf(covariance);
  // A line as float32 has a second variance of its rounding only.
  const double rounding = 1e-12 * ((origin + mean).squaredNorm() + variances[2]);
  if (variances[2] <= rounding) return Spread::kNone;
  return variances[1] <= rounding ? Spread::kLine : Spread::kArea;
}

std::string_view PackedPoints(const Scan& scan) {
  static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));
  return {reinterpret_cast<const char*>(scan.points.data()), scan.points.size() * sizeof(Eigen::Vector3f)};
}

// As many are first tested as one: a scan has few points that are not finite.
constexpr size_t kBytesPerLook = 256 * sizeof(Eigen::Vector3f);

// Whatever the points that the `count` floats are of: so many are tested at once.
CURVEREG_DISPATCH bool AllFinite(const char* floats, size_t count) {
  constexpr uint32_t kExponent = 0x7f800000U;  // all of it set: infinite or not a number
  uint32_t found = 0;
  for (size_t i = 0; i < count; ++i) {
    uint32_t bits = 0;
    std::memcpy(&bits, floats + i * sizeof(bits), sizeof(bits));
    found |= (bits & kExponent) == kExponent ? 1U : 0U;
  }
  return found == 0;
}

int64_t CountOneByOne(std::string_view points) {
  int64_t count = 0;
  for (std::size_t offset = 0; offset < points.size(); offset += sizeof(Eigen::Vector3f)) {
    float p[3];
    std::memcpy(p, points.data() + offset, sizeof(p));
    // 0 times what is not finite is not a number; no branch.
    count += p[0] * 0.0F + p[1] * 0.0F + p[2] * 0.0F == 0.0F ? 1 : 0;
  }
  return count;
}

// Of whole packed points, which need not be aligned.
int64_t CountFinite(std::string_view points) {
  int64_t count = 0;
  for (; !points.empty(); points.remove_prefix(std::min(points.size(), kBytesPerLook))) {
    const std::string_view block = points.substr(0, kBytesPerLook);
    const bool all = AllFinite(block.data(), block.size() / sizeof(float));
    count += all ? static_cast<int64_t>(block.size() / sizeof(Eigen::Vector3f)) : CountOneByOne(block);
  }
  return count;
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
  const PointCounts counts = CountPoints(scan.points, stop);
  if (stop.Requested()) return absl::OkStatus();
  if (counts.largest > limits.max_coordinate_m) {
    return absl::InvalidArgumentError(
        absl::StrFormat("scan has a coordinate beyond %g m; is it in metres?", limits.max_coordinate_m));
  }
  if (counts.num_finite < limits.min_points) {
    return absl::InvalidArgumentError(
        absl::StrCat("scan has ", counts.num_finite, " finite points; at least ", limits.min_points, " are needed"));
  }
  // Points that span an area do so whatever the others are; only a sample that does not calls for a look at all.
  constexpr size_t kSampleSize = 4096;
  Spread spread = MeasureSpread(scan.points, 1 + scan.points.size() / kSampleSize, stop);
  if (spread != Spread::kArea) spread = MeasureSpread(scan.points, 1, stop);
  if (stop.Requested() || spread == Spread::kArea) return absl::OkStatus();
  if (spread == Spread::kNone) return absl::InvalidArgumentError("all points of the scan are equal");
  return absl::InvalidArgumentError("all points of the scan lie on one line");
}

int64_t CountFinitePoints(const Scan& scan) { return CountFinite(PackedPoints(scan)); }

std::string ScanDigest(const Scan& scan) { return ScanDigestOfHash(HashOf(PackedPoints(scan)), scan.gravity); }

std::string ScanDigestOfHash(uint64_t points_hash, const std::optional<Eigen::Vector3d>& gravity) {
  if (!gravity.has_value()) return absl::StrFormat("%016x", points_hash);
  const std::string_view direction(reinterpret_cast<const char*>(gravity->data()), 3 * sizeof(double));
  return absl::StrFormat("%016x", HashOf(direction, points_hash));
}

void FinitePointCounter::Update(std::string_view bytes) {
  if (partial_size_ > 0) {
    const std::size_t size = std::min(partial_.size() - partial_size_, bytes.size());
    std::memcpy(partial_.data() + partial_size_, bytes.data(), size);
    partial_size_ += size;
    bytes.remove_prefix(size);
    if (partial_size_ < partial_.size()) return;
    count_ += CountFinite({partial_.data(), partial_.size()});
  }
  const std::size_t whole = bytes.size() / sizeof(Eigen::Vector3f) * sizeof(Eigen::Vector3f);
  count_ += CountFinite(bytes.substr(0, whole));
  partial_size_ = bytes.size() - whole;
  std::memcpy(partial_.data(), bytes.data() + whole, partial_size_);
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
