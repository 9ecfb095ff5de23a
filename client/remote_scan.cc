// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/remote_scan.h"

#include <chrono>
#include <string>
#include <utility>

#include "wire/point_codec.h"
#include "wire/timestamp.h"

namespace curvereg::internal {
namespace {

std::string EncodingName(v1::PointEncoding encoding) {
  switch (encoding) {
    case v1::POINT_ENCODING_RAW:
      return "raw";
    case v1::POINT_ENCODING_SHUFFLED_ZSTD:
      return "lossless";
    case v1::POINT_ENCODING_QUANTIZED_ZSTD:
      return "quantized";
    default:
      return "unknown";  // of a newer server
  }
}

v1::PointEncoding WireEncoding(TransferEncoding::Kind kind) {
  switch (kind) {
    case TransferEncoding::Kind::kRaw:
      return v1::POINT_ENCODING_RAW;
    case TransferEncoding::Kind::kLossless:
      return v1::POINT_ENCODING_SHUFFLED_ZSTD;
    case TransferEncoding::Kind::kQuantized:
      return v1::POINT_ENCODING_QUANTIZED_ZSTD;
  }
  return v1::POINT_ENCODING_UNSPECIFIED;
}

}  // namespace

RemoteScan FromWire(const v1::Scan& scan) {
  RemoteScan result;
  result.name = scan.name();
  result.num_points = scan.header().point_count();
  result.num_finite_points = scan.finite_point_count();
  result.payload_bytes = scan.payload_bytes();
  result.encoding = EncodingName(scan.header().encoding());
  if (scan.header().encoding() == v1::POINT_ENCODING_QUANTIZED_ZSTD) {
    result.max_error_m = scan.header().quantization().max_error_m();
  }
  result.content_digest = scan.content_digest();
  result.frame_id = scan.header().frame_id();
  result.create_time = wire::TimePointOf(wire::NanosecondsOf(scan.create_time()).value_or(0));
  return result;
}

absl::StatusOr<v1::PointCloud> EncodeFor(const TransferEncoding& encoding, const curvereg::Scan& scan) {
  return wire::EncodeScan(scan, {.encoding = WireEncoding(encoding.kind), .max_error_m = encoding.max_error_m});
}

absl::StatusOr<v1::ScanInput> ScanInputOf(const ScanReference& reference, const TransferEncoding& encoding) {
  v1::ScanInput input;
  if (const auto* name = std::get_if<std::string>(&reference)) {
    if (name->empty()) return absl::InvalidArgumentError("the name of a scan is empty");
    input.set_name(*name);
    return input;
  }
  absl::StatusOr<v1::PointCloud> cloud =
      EncodeFor(encoding, std::get<std::reference_wrapper<const curvereg::Scan>>(reference).get());
  if (!cloud.ok()) return cloud.status();
  *input.mutable_inline_scan() = *std::move(cloud);
  return input;
}

}  // namespace curvereg::internal
