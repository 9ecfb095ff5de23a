// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Clouds to and from the layouts of ROS sensor_msgs/PointCloud2 and foxglove.PointCloud, without loss: the packed bytes
// stay as they are. The structs mirror those messages field by field, so that no ROS or foxglove package is needed.
#ifndef CURVEREG_WIRE_SENSOR_MESSAGES_H_
#define CURVEREG_WIRE_SENSOR_MESSAGES_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "curvereg/v1/point_cloud.pb.h"

namespace curvereg::wire {

struct RosPointField {
  std::string name;
  uint32_t offset = 0;
  uint8_t datatype = 0;  // 1 INT8, 2 UINT8, 3 INT16, 4 UINT16, 5 INT32, 6 UINT32, 7 FLOAT32, 8 FLOAT64
  uint32_t count = 1;

  friend bool operator==(const RosPointField&, const RosPointField&) = default;
};

struct RosPointCloud2 {
  int32_t stamp_sec = 0;
  uint32_t stamp_nanosec = 0;
  std::string frame_id;
  uint32_t height = 1;
  uint32_t width = 0;
  std::vector<RosPointField> fields;
  bool is_bigendian = false;
  uint32_t point_step = 0;
  uint32_t row_step = 0;
  std::string data;
  bool is_dense = false;  // on the way out: true exactly when all points are finite

  friend bool operator==(const RosPointCloud2&, const RosPointCloud2&) = default;
};

struct FoxglovePackedField {
  std::string name;
  uint32_t offset = 0;
  int type = 0;  // 1 UINT8, 2 INT8, 3 UINT16, 4 INT16, 5 UINT32, 6 INT32, 7 FLOAT32, 8 FLOAT64

  friend bool operator==(const FoxglovePackedField&, const FoxglovePackedField&) = default;
};

struct FoxglovePointCloud {
  int64_t timestamp_sec = 0;
  uint32_t timestamp_nsec = 0;
  std::string frame_id;
  double position[3] = {0, 0, 0};        // origin of the cloud relative to the frame [m]
  double orientation[4] = {0, 0, 0, 1};  // x y z w
  uint32_t point_stride = 0;
  std::vector<FoxglovePackedField> fields;
  std::string data;

  friend bool operator==(const FoxglovePointCloud&, const FoxglovePointCloud&) = default;
};

// A stamp of zero is an unknown time. foxglove's pose is t_world_sensor, absent for the identity: frame_id names the
// frame that the pose is in. ROS has no place for a pose, neither has one for gravity; they stay behind.

// INVALID_FIELD: big-endian data, sizes that do not agree, and what makes a header invalid ("header.layout.fields",
// ...).
absl::StatusOr<v1::PointCloud> FromRos(const RosPointCloud2& message);
absl::StatusOr<v1::PointCloud> FromFoxglove(const FoxglovePointCloud& message);

// Clouds of every encoding; those that are not RAW are decoded first, within the default PointLimits. Errors of
// DecodeScan. foxglove has neither rows nor fields of several numbers: INVALID_FIELD where the layout pads rows; a
// field of count n becomes n fields name_i. INVALID_FIELD, too, where a time or a size does not fit 32 bits of ROS.
absl::StatusOr<RosPointCloud2> ToRos(const v1::PointCloud& cloud);
absl::StatusOr<FoxglovePointCloud> ToFoxglove(const v1::PointCloud& cloud);

}  // namespace curvereg::wire

#endif  // CURVEREG_WIRE_SENSOR_MESSAGES_H_
