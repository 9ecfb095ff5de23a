// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What a cloud's header may say, checked before any memory is taken for its points.
#ifndef CURVEREG_WIRE_CLOUD_HEADER_H_
#define CURVEREG_WIRE_CLOUD_HEADER_H_

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "absl/status/status.h"
#include "curvereg/v1/point_cloud.pb.h"

namespace curvereg::wire {

// What a decoder takes at most. A header is checked against it before any memory is taken.
struct PointLimits {
  uint64_t max_points = 50'000'000;
  uint64_t max_payload_bytes = uint64_t{1} << 31;  // of the payload, and of the block that it decompresses to
};

// No frame of zstd holds more bytes than this for each of its own: a block holds at most 128 KiB and takes at least 4.
inline constexpr uint64_t kMaxZstdRatio = 32768;

// INVALID_FIELD naming the field within the header, SCAN_TOO_LARGE: a header that no payload can satisfy, or that asks
// for more than the limits. `payload_bytes`: of the payload that goes with it.
absl::Status ValidateHeader(const v1::PointCloudHeader& header, uint64_t payload_bytes, const PointLimits& limits);

// Bytes of the packed block before compression; the greatest number where 64 bits do not hold it.
uint64_t BlockBytes(const v1::PointCloudHeader& header);

// Of a header that passed ValidateHeader.
std::optional<Eigen::Vector3d> GravityOf(const v1::PointCloudHeader& header);

}  // namespace curvereg::wire

#endif  // CURVEREG_WIRE_CLOUD_HEADER_H_
