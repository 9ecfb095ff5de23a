// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Any bytes as a cloud from the wire.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "wire/error.h"
#include "wire/point_codec.h"
#include "wire/sensor_messages.h"
#include "wire/zstd_frame.h"

namespace curvereg::wire {
namespace {

constexpr PointLimits kLimits = {.max_points = 100'000, .max_payload_bytes = uint64_t{1} << 22};

void Require(bool holds) {
  if (!holds) std::abort();
}

void CheckError(const absl::Status& status) {
  const auto reason = ReasonOf(status);
  Require(reason == v1::ERROR_REASON_INVALID_FIELD || reason == v1::ERROR_REASON_SCAN_TOO_LARGE ||
          reason == v1::ERROR_REASON_MALFORMED_PAYLOAD);
  Require(!status.message().empty());
}

bool SamePoints(const Scan& a, const Scan& b) {
  return a.points.size() == b.points.size() &&
         (a.points.empty() ||
          std::memcmp(a.points.data(), b.points.data(), a.points.size() * sizeof(Eigen::Vector3f)) == 0);
}

// What is quantised again is near, and missing where it was missing.
void CheckQuantization(const Scan& scan) {
  PointEncodingOptions options;
  options.encoding = v1::POINT_ENCODING_QUANTIZED_ZSTD;
  const auto cloud = EncodeScan(scan, options);
  if (!cloud.ok()) return CheckError(cloud.status());
  const auto back = DecodeScan(cloud->header(), cloud->data(), {});
  Require(back.ok() && back->points.size() == scan.points.size());
  for (size_t i = 0; i < scan.points.size(); ++i) {
    const Eigen::Vector3d error = back->points[i].cast<double>() - scan.points[i].cast<double>();
    Require(scan.points[i].allFinite() ? error.norm() <= options.max_error_m : !back->points[i].allFinite());
  }
}

void CheckMessages(const v1::PointCloud& cloud, const Scan& scan) {
  if (const auto message = ToRos(cloud); message.ok()) {
    const auto back = FromRos(*message);
    Require(back.ok());
    const auto scan_back = DecodeScan(back->header(), back->data(), {});
    Require(scan_back.ok() && SamePoints(*scan_back, scan));
    Require(*ToRos(*back) == *message);
    Require(message->is_dense ==
            std::all_of(scan.points.begin(), scan.points.end(), [](const auto& point) { return point.allFinite(); }));
  } else {
    CheckError(message.status());
  }
  if (const auto message = ToFoxglove(cloud); message.ok()) {
    Require(message->data.size() == cloud.header().point_count() * message->point_stride);
    if (const auto back = FromFoxglove(*message); !back.ok()) CheckError(back.status());
  } else {
    CheckError(message.status());
  }
}

void CheckCloud(const v1::PointCloud& cloud) {
  const v1::PointCloudHeader& header = cloud.header();
  const absl::Status valid = ValidateHeader(header, cloud.data().size(), kLimits);
  const auto scan = DecodeScan(header, cloud.data(), kLimits);
  if (!scan.ok()) {
    Require(valid.ok() || valid.message() == scan.status().message());
    return CheckError(scan.status());
  }
  Require(valid.ok() && scan->points.size() == header.point_count() && header.point_count() <= kLimits.max_points);
  Require(DecodingBytes(header) >= scan->points.size() * sizeof(Eigen::Vector3f));
  Require(scan->gravity.has_value() == header.has_gravity());
  CheckQuantization(*scan);
  CheckMessages(cloud, *scan);
}

}  // namespace
}  // namespace curvereg::wire

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  curvereg::v1::PointCloud cloud;
  if (!cloud.ParseFromArray(data, static_cast<int>(size))) return 0;
  curvereg::wire::CheckCloud(cloud);
  // Few changed bytes get past a frame's checksum: so that what comes after it is met, too, the data as a frame.
  if (cloud.header().encoding() == curvereg::v1::POINT_ENCODING_RAW) return 0;
  cloud.set_data(*curvereg::wire::CompressFrame(cloud.data(), 1));
  curvereg::wire::CheckCloud(cloud);
  return 0;
}
