// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Clouds to and from packed bytes. Frame and unit of points as in core/scan/scan.h.
#ifndef CURVEREG_WIRE_POINT_CODEC_H_
#define CURVEREG_WIRE_POINT_CODEC_H_

#include <cstdint>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "core/scan/scan.h"
#include "curvereg/v1/point_cloud.pb.h"
#include "wire/cloud_header.h"

namespace curvereg::wire {

struct PointEncodingOptions {
  v1::PointEncoding encoding = v1::POINT_ENCODING_RAW;
  double max_error_m = 1e-3;  // of QUANTIZED_ZSTD: no decoded point is farther from its original [m]
  int zstd_level = 1;         // higher is smaller and slower; gains little on scans
};

// The scan with its gravity as a cloud: float32 x y z, or quantised. Points without a return stay so, order is kept.
// INVALID_FIELD: encoding unknown; max_error_m not above 0, or too small for coordinates of this size in 4 bytes.
absl::StatusOr<v1::PointCloud> EncodeScan(const Scan& scan, const PointEncodingOptions& options = {});

// Most bytes of memory that DecodeScan takes for a header that passed ValidateHeader, its result included.
uint64_t DecodingBytes(const v1::PointCloudHeader& header);

// The scan. Errors of ValidateHeader; MALFORMED_PAYLOAD: the bytes do not decode to exactly what the header declares.
// Takes no more memory than DecodingBytes whatever the bytes say. Coordinates beyond float32 become "no return".
absl::StatusOr<Scan> DecodeScan(const v1::PointCloudHeader& header, std::string_view payload,
                                const PointLimits& limits);

// The packed block as the layout tells, all fields. Errors of DecodeScan; INVALID_FIELD "encoding" for clouds that have
// no layout. Takes at most twice BlockBytes and kDecompressorBytes.
absl::StatusOr<std::string> DecodeBlock(const v1::PointCloudHeader& header, std::string_view payload,
                                        const PointLimits& limits);

}  // namespace curvereg::wire

#endif  // CURVEREG_WIRE_POINT_CODEC_H_
