// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/quantization.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "absl/strings/str_format.h"
#include "wire/error.h"

namespace curvereg::wire {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// Points converted together: loops over a tile have one thing to do and the compiler makes vectors of them.
constexpr size_t kTile = 256;
using Tile = std::array<std::array<uint32_t, kTile>, 3>;  // integers by axis

// The greatest integer of b bytes: on the x axis, no return.
uint32_t GreatestInteger(uint32_t bytes) { return static_cast<uint32_t>((uint64_t{1} << (8 * bytes)) - 1); }

Eigen::Vector3d OriginOf(const v1::Quantization& quantization) {
  return {quantization.origin().x(), quantization.origin().y(), quantization.origin().z()};
}

struct Extent {
  Eigen::Vector3f least = Eigen::Vector3f::Constant(std::numeric_limits<float>::infinity());
  Eigen::Vector3f greatest = Eigen::Vector3f::Constant(-std::numeric_limits<float>::infinity());
};

Extent ExtentOf(const std::vector<Eigen::Vector3f>& points) {
  Extent extent;
  for (const Eigen::Vector3f& point : points) {
    if (!point.allFinite()) continue;
    extent.least = extent.least.cwiseMin(point);
    extent.greatest = extent.greatest.cwiseMax(point);
  }
  if (!extent.least.allFinite()) return {Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero()};  // no return at all
  return extent;
}

// The greatest step that keeps the promise for coordinates up to `largest`; not above 0 where there is none.
double GreatestStep(double max_error_m, double largest) {
  // What is left to each axis. Arithmetic in double precision errs by less than 2^-47 of the largest coordinate.
  const double error = max_error_m * (1.0 - 0x1p-40) / std::numbers::sqrt3 - 0x1p-47 * largest;
  // An integer is off by half a step at most. Rounding to float32 adds at most 2^-24 of the coordinate, and never more
  // than the integer is off: the original is a float32, too, so the nearest one is no farther.
  return std::max(error, 2.0 * (error - 0x1p-24 * (largest + max_error_m)));
}

void QuantizeTile(const Eigen::Vector3f* points, size_t num_points, const v1::Quantization& quantization, Tile& tile) {
  const Eigen::Vector3d origin = OriginOf(quantization);
  const double step = quantization.step_m();
  const uint32_t no_return = GreatestInteger(quantization.bytes_per_coordinate());
  for (size_t i = 0; i < num_points; ++i) {
    const bool is_return = points[i].allFinite();
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const double steps = (static_cast<double>(points[i][axis]) - origin[axis]) / step;
      // All axes of a missing return get the mark: equal bytes cost nothing.
      tile[static_cast<size_t>(axis)][i] =
          is_return ? static_cast<uint32_t>(static_cast<int64_t>(steps + 0.5)) : no_return;
    }
  }
}

void DequantizeTile(const Tile& tile, const v1::Quantization& quantization, size_t num_points,
                    Eigen::Vector3f* points) {
  constexpr double kMaxFloat = std::numeric_limits<float>::max();
  const Eigen::Vector3d origin = OriginOf(quantization);
  const double step = quantization.step_m();
  const uint32_t no_return = GreatestInteger(quantization.bytes_per_coordinate());
  for (size_t i = 0; i < num_points; ++i) {
    const bool is_return = tile[0][i] != no_return;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const double coordinate = origin[axis] + step * static_cast<double>(tile[static_cast<size_t>(axis)][i]);
      points[i][axis] = is_return && std::abs(coordinate) <= kMaxFloat ? static_cast<float>(coordinate) : kNan;
    }
  }
}

}  // namespace

absl::StatusOr<v1::Quantization> ChooseQuantization(const std::vector<Eigen::Vector3f>& points, double max_error_m) {
  const Extent extent = ExtentOf(points);
  const double largest = std::max<double>(extent.least.cwiseAbs().maxCoeff(), extent.greatest.cwiseAbs().maxCoeff());
  const double step = GreatestStep(max_error_m, largest);
  if (!(max_error_m > 0.0) || !std::isfinite(step)) return FieldError("max_error_m", "must be finite and above 0");
  const double steps = (extent.greatest.cast<double>() - extent.least.cast<double>()).maxCoeff() / step + 1.0;
  uint32_t bytes = 2;
  while (bytes < 4 && steps >= GreatestInteger(bytes)) ++bytes;
  if (step <= 0.0 || steps >= GreatestInteger(bytes)) {
    return FieldError("max_error_m", absl::StrFormat("4 bytes do not hold coordinates of this size (%g m) to %g m",
                                                     largest, max_error_m));
  }
  v1::Quantization quantization;
  quantization.mutable_origin()->set_x(extent.least.x());
  quantization.mutable_origin()->set_y(extent.least.y());
  quantization.mutable_origin()->set_z(extent.least.z());
  quantization.set_step_m(step);
  quantization.set_bytes_per_coordinate(bytes);
  quantization.set_max_error_m(max_error_m);
  return quantization;
}

void QuantizePoints(const std::vector<Eigen::Vector3f>& points, const v1::Quantization& quantization, char* planes) {
  const uint32_t bytes = quantization.bytes_per_coordinate();
  Tile tile;
  for (size_t begin = 0; begin < points.size(); begin += kTile) {
    const size_t num_points = std::min(kTile, points.size() - begin);
    QuantizeTile(&points[begin], num_points, quantization, tile);
    for (size_t plane = 0; plane < 3 * bytes; ++plane) {
      char* out = planes + plane * points.size() + begin;
      const uint32_t* integers = tile[plane / bytes].data();
      const auto shift = static_cast<uint32_t>(8 * (plane % bytes));
      for (size_t i = 0; i < num_points; ++i) out[i] = static_cast<char>(integers[i] >> shift);
    }
  }
}

void DequantizePoints(std::string_view planes, const v1::Quantization& quantization,
                      std::vector<Eigen::Vector3f>& points) {
  const uint32_t bytes = quantization.bytes_per_coordinate();
  for (size_t begin = 0; begin < points.size(); begin += kTile) {
    const size_t num_points = std::min(kTile, points.size() - begin);
    Tile tile = {};
    for (size_t plane = 0; plane < 3 * bytes; ++plane) {
      const char* in = planes.data() + plane * points.size() + begin;
      uint32_t* integers = tile[plane / bytes].data();
      const auto shift = static_cast<uint32_t>(8 * (plane % bytes));
      for (size_t i = 0; i < num_points; ++i) integers[i] |= uint32_t{static_cast<unsigned char>(in[i])} << shift;
    }
    DequantizeTile(tile, quantization, num_points, &points[begin]);
  }
}

}  // namespace curvereg::wire
