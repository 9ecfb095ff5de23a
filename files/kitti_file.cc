// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/kitti_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "files/read_progress.h"

namespace curvereg {
namespace {

constexpr std::size_t kPointBytes = 16;

// False for finite numbers that are no coordinate of a laser scan.
bool IsPlausible(float value) {
  const float magnitude = std::abs(value);
  return !std::isfinite(value) || magnitude == 0.0F || (magnitude > 1e-9F && magnitude < 1e6F);
}

}  // namespace

absl::StatusOr<Scan> ParseKitti(std::string_view bytes, const CloudReadOptions& options) {
  if (bytes.size() % kPointBytes != 0) {
    return absl::DataLossError(
        absl::StrCat("truncated, or not KITTI: the size of ", bytes.size(), " bytes is not a multiple of 16"));
  }
  const std::size_t num_points = bytes.size() / kPointBytes;
  if (num_points > static_cast<uint64_t>(std::max<int64_t>(options.max_points, 0))) {
    return absl::ResourceExhaustedError(
        absl::StrCat("contains ", num_points, " points, more than the limit of ", options.max_points));
  }
  Scan scan;
  scan.points.resize(num_points);
  std::size_t num_implausible = 0;
  ReadProgress progress(options, num_points);
  for (std::size_t i = 0; i < num_points; ++i) {
    Eigen::Vector3f& point = scan.points[i];
    std::memcpy(point.data(), bytes.data() + i * kPointBytes, sizeof(point));
    if (!IsPlausible(point.x()) || !IsPlausible(point.y()) || !IsPlausible(point.z())) ++num_implausible;
    progress.At(i);
  }
  if (2 * num_implausible > num_points) {
    return absl::InvalidArgumentError(absl::StrCat("not a KITTI cloud: ", num_implausible, " of ", num_points,
                                                   " points are not coordinates in metres"));
  }
  return scan;
}

void AppendKitti(const Scan& scan, AtomicFile& file) {
  for (const Eigen::Vector3f& point : scan.points) {
    char bytes[kPointBytes] = {};
    std::memcpy(bytes, point.data(), sizeof(point));
    file.Append(std::string_view(bytes, kPointBytes));
  }
}

}  // namespace curvereg
