// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/cloud_header.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "wire/error.h"
#include "wire/geometry_conversion.h"
#include "wire/plain_text.h"
#include "wire/point_layout.h"

namespace curvereg::wire {
namespace {

constexpr size_t kMaxFrameIdBytes = 128;

absl::Status TooLarge(std::string_view what, uint64_t value, uint64_t limit) {
  return MakeError(v1::ERROR_REASON_SCAN_TOO_LARGE,
                   absl::StrCat(value, " ", std::string(what), "; at most ", limit, " are taken"),
                   {{"limit", absl::StrCat(limit)}, {"value", absl::StrCat(value)}});
}

// The range of google.protobuf.Timestamp.
bool IsTime(const google::protobuf::Timestamp& time) {
  constexpr int64_t kYear1 = -62'135'596'800;
  constexpr int64_t kYear10000 = 253'402'300'800;
  return time.seconds() >= kYear1 && time.seconds() < kYear10000 && time.nanos() >= 0 && time.nanos() < 1'000'000'000;
}

bool IsDirection(const v1::Vector3& vector) {
  const double length = std::hypot(vector.x(), vector.y(), vector.z());
  return std::isfinite(length) && length > 0.0;
}

// All that does not tell how the points are packed.
absl::Status ValidateDescription(const v1::PointCloudHeader& header) {
  if (header.frame_id().size() > kMaxFrameIdBytes || !IsPlainText(header.frame_id())) {
    return FieldError("frame_id", absl::StrCat("must be at most ", kMaxFrameIdBytes, " bytes of text"));
  }
  if (header.has_time() && !IsTime(header.time())) {
    return FieldError("time", "must lie in the years 1 to 9999, nanos in 0 to 999999999");
  }
  if (header.has_gravity() && !IsDirection(header.gravity())) {
    return FieldError("gravity", "must be finite and longer than 0");
  }
  if (!header.has_t_world_sensor()) return absl::OkStatus();
  return WithinField("t_world_sensor", FromWire(header.t_world_sensor()).status());
}

absl::Status ValidateQuantization(const v1::Quantization& quantization) {
  const v1::Vector3& origin = quantization.origin();
  if (!std::isfinite(origin.x()) || !std::isfinite(origin.y()) || !std::isfinite(origin.z())) {
    return FieldError("origin", "not finite");
  }
  const double step = quantization.step_m();
  if (!std::isfinite(step) || step <= 0.0) return FieldError("step_m", "must be finite and above 0");
  const uint32_t bytes = quantization.bytes_per_coordinate();
  if (bytes < 2 || bytes > 4) return FieldError("bytes_per_coordinate", "must be 2, 3 or 4");
  const double max_error = quantization.max_error_m();
  constexpr double kRounding = 1.0 - 1e-9;  // of the caller's square root
  if (!std::isfinite(max_error) || max_error < 0.5 * std::numbers::sqrt3 * kRounding * step) {
    return FieldError("max_error_m", "must be finite and at least sqrt(3)/2 of step_m");
  }
  return absl::OkStatus();
}

absl::Status ValidatePacking(const v1::PointCloudHeader& header) {
  switch (header.encoding()) {
    case v1::POINT_ENCODING_SHUFFLED_ZSTD:
      if (header.layout().row_padding() != 0) return FieldError("layout.row_padding", "only of the encoding RAW");
      [[fallthrough]];
    case v1::POINT_ENCODING_RAW:
      if (!header.has_layout()) return FieldError("layout", "missing");
      if (header.has_quantization()) return FieldError("quantization", "only of the encoding QUANTIZED_ZSTD");
      return WithinField("layout", ValidateLayout(header.layout(), header.point_count()));
    case v1::POINT_ENCODING_QUANTIZED_ZSTD:
      if (header.has_layout()) return FieldError("layout", "not of the encoding QUANTIZED_ZSTD");
      if (!header.has_quantization()) return FieldError("quantization", "missing");
      return WithinField("quantization", ValidateQuantization(header.quantization()));
    default:
      return FieldError("encoding", "not a known encoding");
  }
}

// Of a header whose other fields are valid.
absl::Status ValidateSize(const v1::PointCloudHeader& header, uint64_t payload_bytes, uint64_t max_bytes) {
  const uint64_t block_bytes = BlockBytes(header);
  if (block_bytes > max_bytes) return TooLarge("bytes of points", block_bytes, max_bytes);
  if (header.encoding() == v1::POINT_ENCODING_RAW) {
    if (block_bytes == payload_bytes) return absl::OkStatus();
    return FieldError("point_count",
                      absl::StrCat("that many points take ", block_bytes, " bytes; the payload has ", payload_bytes));
  }
  if (block_bytes / kMaxZstdRatio <= payload_bytes) return absl::OkStatus();
  return FieldError("point_count", absl::StrCat("no ", payload_bytes, " bytes of zstd hold that many points"));
}

}  // namespace

absl::Status ValidateHeader(const v1::PointCloudHeader& header, uint64_t payload_bytes, const PointLimits& limits) {
  if (header.point_count() > limits.max_points) return TooLarge("points", header.point_count(), limits.max_points);
  if (payload_bytes > limits.max_payload_bytes) {
    return TooLarge("bytes of payload", payload_bytes, limits.max_payload_bytes);
  }
  if (absl::Status status = ValidateDescription(header); !status.ok()) return status;
  if (absl::Status status = ValidatePacking(header); !status.ok()) return status;
  return ValidateSize(header, payload_bytes, limits.max_payload_bytes);
}

uint64_t BlockBytes(const v1::PointCloudHeader& header) {
  if (header.encoding() != v1::POINT_ENCODING_QUANTIZED_ZSTD) {
    return LayoutBytes(header.layout(), header.point_count());
  }
  const uint64_t point_bytes = 3 * uint64_t{header.quantization().bytes_per_coordinate()};
  uint64_t bytes = 0;
  const bool is_beyond = __builtin_mul_overflow(header.point_count(), point_bytes, &bytes);
  return is_beyond ? std::numeric_limits<uint64_t>::max() : bytes;
}

std::optional<Eigen::Vector3d> GravityOf(const v1::PointCloudHeader& header) {
  if (!header.has_gravity()) return std::nullopt;
  return Eigen::Vector3d(header.gravity().x(), header.gravity().y(), header.gravity().z());
}

}  // namespace curvereg::wire
