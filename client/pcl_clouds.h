// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Scans from PCL's clouds and back. Point i of one is point i of the other, coordinates bit by bit [m]; NaN and
// infinity mean "no return" on both sides and stay in place.
//
// Frame: a Scan lies in the sensor frame with its origin at the sensor, because what lies between origin and point was
// seen to be free. So must the cloud: a cloud in the frame of the vehicle is to be moved there first
// (pcl::transformPointCloud). sensor_origin_ and sensor_orientation_ are not applied.
//
// Not carried over: fields other than x, y and z (intensity, ring, normals, colour), the header's time and frame, width
// and height (scans become clouds of one row), and a scan's gravity. Cost: one pass and a copy.
#ifndef CURVEREG_CLIENT_PCL_CLOUDS_H_
#define CURVEREG_CLIENT_PCL_CLOUDS_H_

#include <pcl/PCLPointCloud2.h>
#include <pcl/PCLPointField.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/type_traits.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "core/scan/scan.h"

namespace curvereg {

// PointT: any type with float x, y and z.
template <typename PointT>
Scan ScanFromPcl(const pcl::PointCloud<PointT>& cloud) {
  static_assert(pcl::traits::has_xyz_v<PointT>, "a point of a scan has x, y and z");
  static_assert(std::is_same_v<decltype(PointT::x), float>, "the coordinates of a scan are floats");
  Scan scan;
  scan.points.reserve(cloud.size());
  for (const PointT& point : cloud) scan.points.emplace_back(point.x, point.y, point.z);
  return scan;
}

// Fields of PointT beyond x, y and z keep PointT's defaults. is_dense says whether all points are finite.
template <typename PointT = pcl::PointXYZ>
pcl::PointCloud<PointT> PclCloudFromScan(const Scan& scan) {
  static_assert(pcl::traits::has_xyz_v<PointT>, "a point of a scan has x, y and z");
  pcl::PointCloud<PointT> cloud;
  cloud.resize(scan.points.size());
  for (size_t i = 0; i < scan.points.size(); ++i) {
    cloud[i].x = scan.points[i].x();
    cloud[i].y = scan.points[i].y();
    cloud[i].z = scan.points[i].z();
  }
  cloud.is_dense = std::ranges::all_of(scan.points, [](const Eigen::Vector3f& point) { return point.allFinite(); });
  return cloud;
}

namespace internal {

// Where the coordinate `name` lies in a point [bytes], or INVALID_ARGUMENT.
inline absl::StatusOr<uint64_t> CoordinateOffset(const pcl::PCLPointCloud2& cloud, const char* name) {
  const auto field = std::ranges::find(cloud.fields, name, &pcl::PCLPointField::name);
  if (field == cloud.fields.end()) return absl::InvalidArgumentError(absl::StrCat("the cloud has no field ", name));
  if (field->datatype != pcl::PCLPointField::FLOAT32) {
    return absl::InvalidArgumentError(
        absl::StrCat("field ", name, " has datatype ", field->datatype, ", not FLOAT32 (7)"));
  }
  if (field->count > 1) {  // PCL writes 0 or 1 for a single value
    return absl::InvalidArgumentError(absl::StrCat("field ", name, " has ", field->count, " values per point, not 1"));
  }
  if (uint64_t{field->offset} + sizeof(float) > cloud.point_step) {
    return absl::InvalidArgumentError(
        absl::StrCat("field ", name, " ends beyond point_step of ", cloud.point_step, " bytes"));
  }
  return field->offset;
}

// OK, or INVALID_ARGUMENT: rows overlap or end beyond the data.
inline absl::Status ValidateRows(const pcl::PCLPointCloud2& cloud) {
  if (cloud.width == 0 || cloud.height == 0) return absl::OkStatus();
  const uint64_t row_bytes = uint64_t{cloud.width} * cloud.point_step;
  if (cloud.height > 1 && cloud.row_step < row_bytes) {
    return absl::InvalidArgumentError(
        absl::StrCat("row_step is ", cloud.row_step, " bytes, less than the ", row_bytes, " of the points of a row"));
  }
  const uint64_t num_bytes = (uint64_t{cloud.height} - 1) * cloud.row_step + row_bytes;
  if (cloud.data.size() < num_bytes) {
    return absl::InvalidArgumentError(
        absl::StrCat("data has ", cloud.data.size(), " bytes, less than the ", num_bytes, " of all points"));
  }
  return absl::OkStatus();
}

}  // namespace internal

// INVALID_ARGUMENT names what is wrong: x, y or z is missing or not one FLOAT32; is_bigendian is not this machine's;
// point_step, row_step and data contradict each other.
inline absl::StatusOr<Scan> ScanFromPcl(const pcl::PCLPointCloud2& cloud) {
  if ((cloud.is_bigendian != 0) != (std::endian::native == std::endian::big)) {
    return absl::InvalidArgumentError("is_bigendian differs from the byte order of this machine");
  }
  constexpr std::array<const char*, 3> kNames = {"x", "y", "z"};
  std::array<uint64_t, 3> offsets{};
  for (size_t axis = 0; axis < kNames.size(); ++axis) {
    const absl::StatusOr<uint64_t> offset = internal::CoordinateOffset(cloud, kNames[axis]);
    if (!offset.ok()) return offset.status();
    offsets[axis] = *offset;
  }
  if (absl::Status status = internal::ValidateRows(cloud); !status.ok()) return status;
  Scan scan;
  scan.points.reserve(size_t{cloud.width} * cloud.height);
  for (uint64_t row = 0; row < cloud.height; ++row) {
    for (uint64_t column = 0; column < cloud.width; ++column) {
      const uint8_t* const bytes = cloud.data.data() + row * cloud.row_step + column * cloud.point_step;
      Eigen::Vector3f& point = scan.points.emplace_back();
      for (size_t axis = 0; axis < offsets.size(); ++axis) {
        std::memcpy(&point[static_cast<Eigen::Index>(axis)], bytes + offsets[axis], sizeof(float));
      }
    }
  }
  return scan;
}

// Fields x, y and z as FLOAT32 without gaps: 12 bytes per point. Precondition: row_step is a 32-bit number, so at most
// 357 million points.
inline pcl::PCLPointCloud2 PclPointCloud2FromScan(const Scan& scan) {
  constexpr pcl::uindex_t kPointStep = 3 * sizeof(float);
  assert(scan.points.size() <= std::numeric_limits<pcl::uindex_t>::max() / kPointStep);
  pcl::PCLPointCloud2 cloud;
  for (const char* name : {"x", "y", "z"}) {
    pcl::PCLPointField& field = cloud.fields.emplace_back();
    field.name = name;
    field.offset = static_cast<pcl::uindex_t>((cloud.fields.size() - 1) * sizeof(float));
    field.datatype = pcl::PCLPointField::FLOAT32;
    field.count = 1;
  }
  cloud.height = 1;
  cloud.width = static_cast<pcl::uindex_t>(scan.points.size());
  cloud.point_step = kPointStep;
  cloud.row_step = cloud.width * kPointStep;
  cloud.data.resize(cloud.row_step);
  if (!scan.points.empty()) std::memcpy(cloud.data.data(), scan.points.data(), cloud.data.size());
  const auto is_finite = [](const Eigen::Vector3f& point) { return point.allFinite(); };
  cloud.is_dense = std::ranges::all_of(scan.points, is_finite) ? 1 : 0;
  return cloud;
}

}  // namespace curvereg

#endif  // CURVEREG_CLIENT_PCL_CLOUDS_H_
