// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/views/range_image.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"

namespace curvereg {
namespace {

// The whole sphere in pixels.
struct Sphere {
  explicit Sphere(double wanted_step_rad)
      : cols(static_cast<int>(std::lround(2.0 * std::numbers::pi / wanted_step_rad))),
        rows((cols + 1) / 2),
        step_rad(2.0 * std::numbers::pi / cols) {}
  int cols;
  int rows;
  double step_rad;
};

struct Pixel {
  int row;  // of the sphere
  int col;
  float range;  // [m]; 0: no return
};

Pixel PixelOf(const Eigen::Vector3f& point, const Sphere& sphere) {
  constexpr float kPi = std::numbers::pi_v<float>;
  const auto inverse_step = static_cast<float>(1.0 / sphere.step_rad);
  const float level = std::hypot(point.x(), point.y());
  const float azimuth = std::atan2(point.y(), point.x());
  const float elevation = std::atan2(point.z(), level);
  const int col = static_cast<int>((kPi - azimuth) * inverse_step);
  const int row = static_cast<int>((0.5F * kPi - elevation) * inverse_step);
  return {std::clamp(row, 0, sphere.rows - 1), col >= sphere.cols ? 0 : std::max(col, 0), std::hypot(level, point.z())};
}

std::vector<Pixel> PixelsOf(const std::vector<Eigen::Vector3f>& points, const Sphere& sphere) {
  std::vector<Pixel> pixels(points.size(), Pixel{0, 0, 0.0F});
  for (size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) continue;
    pixels[i] = PixelOf(points[i], sphere);
    if (!std::isfinite(pixels[i].range)) pixels[i].range = 0.0F;
  }
  return pixels;
}

struct RowSpan {
  int first = 0;
  int count = 0;
};

RowSpan SpanOf(const std::vector<Pixel>& pixels, const Sphere& sphere, const RangeImageOptions& options) {
  int first = std::numeric_limits<int>::max();
  int last = -1;
  for (const Pixel& pixel : pixels) {
    if (pixel.range <= 0.0F) continue;
    first = std::min(first, pixel.row);
    last = std::max(last, pixel.row);
  }
  if (last < 0) return {};
  if (options.full_sphere) return {0, sphere.rows};
  const int count = std::min(std::max(last - first + 1, options.min_rows), sphere.rows);
  first -= (count - (last - first + 1)) / 2;
  return {std::clamp(first, 0, sphere.rows - count), count};
}

absl::Status Validate(const std::vector<Eigen::Vector3f>& points, const RangeImageOptions& options) {
  if (!(options.step_rad >= 0.0005 && options.step_rad <= 0.2)) {
    return absl::InvalidArgumentError(
        absl::StrCat("range image: step of ", options.step_rad, " rad is outside of 0.0005 to 0.2"));
  }
  if (points.size() > static_cast<size_t>(std::numeric_limits<int32_t>::max())) {
    return absl::InvalidArgumentError(absl::StrCat("range image: ", points.size(), " points are too many"));
  }
  return absl::OkStatus();
}

// Index of the pixel's neighbour with a return, -1 without one.
int32_t NeighbourOf(const Image<int32_t>& point, int row, int col, const BearingAngleOptions& options) {
  for (int gap = 1; gap <= options.max_gap_px; ++gap) {
    int other_row = row;
    int other_col = col;
    if (options.direction == BearingDirection::kAlongColumn) {
      other_row += gap;
      if (other_row >= point.rows) return -1;
    } else {
      if (gap >= point.cols) return -1;
      other_col = (col - gap + point.cols) % point.cols;
    }
    if (point(other_row, other_col) >= 0) return point(other_row, other_col);
  }
  return -1;
}

}  // namespace

absl::StatusOr<RangeImage> ComputeRangeImage(const std::vector<Eigen::Vector3f>& points,
                                             const RangeImageOptions& options) {
  if (absl::Status status = Validate(points, options); !status.ok()) return status;
  const Sphere sphere(options.step_rad);
  const std::vector<Pixel> pixels = PixelsOf(points, sphere);
  const RowSpan span = SpanOf(pixels, sphere, options);
  RangeImage image;
  image.step_rad = sphere.step_rad;
  if (span.count == 0) return image;
  image.first_row = span.first;
  image.range = Image<float>(span.count, sphere.cols);
  image.valid = Image<uint8_t>(span.count, sphere.cols);
  image.point = Image<int32_t>(span.count, sphere.cols, -1);
  for (size_t i = 0; i < pixels.size(); ++i) {
    const Pixel& pixel = pixels[i];
    if (pixel.range <= 0.0F) continue;
    const size_t index = image.range.Index(pixel.row - span.first, pixel.col);
    if (image.valid.pixels[index] != 0 && image.range.pixels[index] <= pixel.range) continue;
    image.range.pixels[index] = pixel.range;
    image.valid.pixels[index] = 1;
    image.point.pixels[index] = static_cast<int32_t>(i);
  }
  return image;
}

BearingAngleImage ComputeBearingAngles(const RangeImage& image, const std::vector<Eigen::Vector3f>& points,
                                       const BearingAngleOptions& options) {
  const Image<int32_t>& point = image.point;
  BearingAngleImage result{Image<float>(point.rows, point.cols), Image<uint8_t>(point.rows, point.cols)};
  for (int row = 0; row < point.rows; ++row) {
    for (int col = 0; col < point.cols; ++col) {
      const int32_t here = point(row, col);
      const int32_t other = here < 0 ? -1 : NeighbourOf(point, row, col, options);
      if (other < 0) continue;
      const Eigen::Vector3d beam = points[static_cast<size_t>(here)].cast<double>();
      const Eigen::Vector3d line = beam - points[static_cast<size_t>(other)].cast<double>();
      const double lengths = beam.norm() * line.norm();
      if (!(lengths > 0.0)) continue;
      result.angle(row, col) = static_cast<float>(std::acos(std::clamp(beam.dot(line) / lengths, -1.0, 1.0)));
      result.valid(row, col) = 1;
    }
  }
  return result;
}

}  // namespace curvereg
