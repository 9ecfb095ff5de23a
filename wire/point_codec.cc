// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/point_codec.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "wire/byte_shuffle.h"
#include "wire/error.h"
#include "wire/point_layout.h"
#include "wire/quantization.h"
#include "wire/zstd_frame.h"

namespace curvereg::wire {
namespace {

using Points = std::vector<Eigen::Vector3f>;
static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float), "a vector of points is a packed block");

std::string_view BytesOf(const Points& points) {
  return {reinterpret_cast<const char*>(points.data()), points.size() * sizeof(Eigen::Vector3f)};
}

float ToFloat(float coordinate) { return coordinate; }
float ToFloat(double coordinate) {
  constexpr double kMaxFloat = std::numeric_limits<float>::max();
  return std::abs(coordinate) <= kMaxFloat ? static_cast<float>(coordinate) : std::numeric_limits<float>::quiet_NaN();
}

// Number: the type of the coordinates in the block. `block` is as the layout tells.
template <typename Number>
void ReadPoints(std::string_view block, const v1::PointLayout& layout, Points& points) {
  const std::array<uint32_t, 3> offsets = PositionsOf(layout).offsets;
  const size_t width = layout.width() == 0 ? points.size() : layout.width();
  const char* in = block.data();
  for (size_t begin = 0; begin < points.size(); begin += width) {
    for (size_t i = begin; i < begin + width; ++i) {
      for (size_t axis = 0; axis < 3; ++axis) {
        Number coordinate;
        std::memcpy(&coordinate, in + offsets[axis], sizeof(Number));
        points[i][static_cast<Eigen::Index>(axis)] = ToFloat(coordinate);
      }
      in += layout.point_stride();
    }
    in += layout.row_padding();
  }
}

// The same from a shuffled block; planes of other fields are not looked at. Bits: the unsigned type of Number's size.
template <typename Number, typename Bits>
void GatherPoints(std::string_view planes, const v1::PointLayout& layout, Points& points) {
  static_assert(sizeof(Number) == sizeof(Bits));
  constexpr size_t kTile = 256;
  const std::array<uint32_t, 3> offsets = PositionsOf(layout).offsets;
  for (size_t begin = 0; begin < points.size(); begin += kTile) {
    const size_t num_points = std::min(kTile, points.size() - begin);
    for (size_t axis = 0; axis < 3; ++axis) {
      std::array<Bits, kTile> bits = {};
      for (size_t byte = 0; byte < sizeof(Bits); ++byte) {
        const char* in = planes.data() + (offsets[axis] + byte) * points.size() + begin;
        for (size_t i = 0; i < num_points; ++i) bits[i] |= Bits{static_cast<unsigned char>(in[i])} << (8 * byte);
      }
      for (size_t i = 0; i < num_points; ++i) {
        points[begin + i][static_cast<Eigen::Index>(axis)] = ToFloat(std::bit_cast<Number>(bits[i]));
      }
    }
  }
}

void DecodeRaw(std::string_view block, const v1::PointLayout& layout, Points& points) {
  if (IsPackedFloats(layout)) {
    if (!block.empty()) std::memcpy(points.data()->data(), block.data(), block.size());
  } else if (PositionsOf(layout).is_double) {
    ReadPoints<double>(block, layout, points);
  } else {
    ReadPoints<float>(block, layout, points);
  }
}

void DecodeShuffled(std::string_view planes, const v1::PointLayout& layout, Points& points) {
  if (PositionsOf(layout).is_double) {
    GatherPoints<double, uint64_t>(planes, layout, points);
  } else {
    GatherPoints<float, uint32_t>(planes, layout, points);
  }
}

// Sets data, layout or quantization for the encoding that the header names.
absl::Status EncodePoints(const Points& points, const PointEncodingOptions& options, v1::PointCloud& cloud) {
  v1::PointCloudHeader& header = *cloud.mutable_header();
  if (options.encoding == v1::POINT_ENCODING_RAW) {
    *header.mutable_layout() = PackedFloatLayout();
    const std::string_view bytes = BytesOf(points);
    cloud.mutable_data()->assign(bytes.data(), bytes.size());
    return absl::OkStatus();
  }
  if (options.encoding == v1::POINT_ENCODING_SHUFFLED_ZSTD) {
    *header.mutable_layout() = PackedFloatLayout();
  } else if (options.encoding == v1::POINT_ENCODING_QUANTIZED_ZSTD) {
    absl::StatusOr<v1::Quantization> quantization = ChooseQuantization(points, options.max_error_m);
    if (!quantization.ok()) return quantization.status();
    *header.mutable_quantization() = *std::move(quantization);
  } else {
    return FieldError("encoding", "not a known encoding");
  }
  const Buffer planes(BlockBytes(header));
  if (header.has_quantization()) {
    QuantizePoints(points, header.quantization(), planes.data.get());
  } else {
    ShuffleBytes(BytesOf(points), sizeof(Eigen::Vector3f), planes.data.get());
  }
  absl::StatusOr<std::string> frame = CompressFrame(planes.View(), options.zstd_level);
  if (!frame.ok()) return frame.status();
  *cloud.mutable_data() = *std::move(frame);
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<v1::PointCloud> EncodeScan(const Scan& scan, const PointEncodingOptions& options) {
  v1::PointCloud cloud;
  v1::PointCloudHeader& header = *cloud.mutable_header();
  header.set_point_count(scan.points.size());
  header.set_encoding(options.encoding);
  if (scan.gravity.has_value()) {
    header.mutable_gravity()->set_x(scan.gravity->x());
    header.mutable_gravity()->set_y(scan.gravity->y());
    header.mutable_gravity()->set_z(scan.gravity->z());
  }
  if (absl::Status status = EncodePoints(scan.points, options, cloud); !status.ok()) return status;
  return cloud;
}

uint64_t DecodingBytes(const v1::PointCloudHeader& header) {
  const uint64_t points_bytes = header.point_count() * sizeof(Eigen::Vector3f);
  if (header.encoding() == v1::POINT_ENCODING_RAW) return points_bytes;
  return points_bytes + BlockBytes(header) + kDecompressorBytes;
}

absl::StatusOr<Scan> DecodeScan(const v1::PointCloudHeader& header, std::string_view payload,
                                const PointLimits& limits) {
  if (absl::Status status = ValidateHeader(header, payload.size(), limits); !status.ok()) return status;
  Scan scan;
  if (header.encoding() == v1::POINT_ENCODING_RAW) {
    scan.points.resize(header.point_count());
    DecodeRaw(payload, header.layout(), scan.points);
  } else {
    const absl::StatusOr<Buffer> planes = DecompressFrame(payload, BlockBytes(header));
    if (!planes.ok()) return planes.status();
    scan.points.resize(header.point_count());
    if (header.has_quantization()) {
      DequantizePoints(planes->View(), header.quantization(), scan.points);
    } else {
      DecodeShuffled(planes->View(), header.layout(), scan.points);
    }
  }
  scan.gravity = GravityOf(header);
  return scan;
}

absl::StatusOr<std::string> DecodeBlock(const v1::PointCloudHeader& header, std::string_view payload,
                                        const PointLimits& limits) {
  if (absl::Status status = ValidateHeader(header, payload.size(), limits); !status.ok()) return status;
  if (header.encoding() == v1::POINT_ENCODING_RAW) return std::string(payload);
  if (header.encoding() != v1::POINT_ENCODING_SHUFFLED_ZSTD) return FieldError("encoding", "has no packed block");
  const absl::StatusOr<Buffer> planes = DecompressFrame(payload, BlockBytes(header));
  if (!planes.ok()) return planes.status();
  std::string block(planes->size, '\0');
  UnshuffleBytes(planes->View(), header.layout().point_stride(), block.data());
  return block;
}

}  // namespace curvereg::wire
