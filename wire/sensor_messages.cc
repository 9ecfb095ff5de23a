// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/sensor_messages.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "wire/cloud_header.h"
#include "wire/error.h"
#include "wire/point_codec.h"
#include "wire/point_layout.h"

namespace curvereg::wire {
namespace {

// Messages lie in memory already: a conversion has no limits of its own.
constexpr PointLimits kNoLimits = {.max_points = std::numeric_limits<uint64_t>::max(),
                                   .max_payload_bytes = std::numeric_limits<uint64_t>::max()};

// foxglove's numbers of the integer types have signed and unsigned the other way round than ROS and v1.NumericType.
int SwapSign(int type) { return type >= 1 && type <= 6 ? (type - 1) / 2 * 4 + 3 - type : type; }

// Zero means unknown, as a message has it whose stamp was never set.
void SetTime(int64_t seconds, uint32_t nanoseconds, v1::PointCloudHeader& header) {
  if (seconds == 0 && nanoseconds == 0) return;
  header.mutable_time()->set_seconds(seconds);
  // What does not fit is kept wrong, for ValidateHeader to refuse.
  header.mutable_time()->set_nanos(static_cast<int32_t>(std::min(nanoseconds, uint32_t{1'000'000'000})));
}

absl::StatusOr<v1::PointCloud> Validated(v1::PointCloud cloud) {
  absl::Status status = ValidateHeader(cloud.header(), cloud.data().size(), kNoLimits);
  if (!status.ok()) return WithinField("header", std::move(status));
  return cloud;
}

void AddField(const std::string& name, uint32_t offset, int type, uint32_t count, v1::PointLayout& layout) {
  v1::PointField* field = layout.add_fields();
  field->set_name(name);
  field->set_offset(offset);
  field->set_type(static_cast<v1::NumericType>(type));
  field->set_count(count);
}

// The cloud as RAW. Errors name fields within the cloud.
absl::StatusOr<v1::PointCloud> Unpacked(const v1::PointCloud& cloud) {
  const v1::PointCloudHeader& header = cloud.header();
  if (header.encoding() == v1::POINT_ENCODING_RAW) return Validated(cloud);
  v1::PointCloud raw;
  if (header.encoding() == v1::POINT_ENCODING_SHUFFLED_ZSTD) {
    absl::StatusOr<std::string> block = DecodeBlock(header, cloud.data(), {});
    if (!block.ok()) return WithinField("header", block.status());
    *raw.mutable_header() = header;
    *raw.mutable_data() = *std::move(block);
  } else {
    const absl::StatusOr<Scan> scan = DecodeScan(header, cloud.data(), {});
    if (!scan.ok()) return WithinField("header", scan.status());
    absl::StatusOr<v1::PointCloud> packed = EncodeScan(*scan);
    if (!packed.ok()) return packed.status();
    raw = *std::move(packed);
    raw.mutable_header()->set_frame_id(header.frame_id());
    if (header.has_time()) *raw.mutable_header()->mutable_time() = header.time();
    if (header.has_t_world_sensor()) *raw.mutable_header()->mutable_t_world_sensor() = header.t_world_sensor();
  }
  raw.mutable_header()->set_encoding(v1::POINT_ENCODING_RAW);
  return raw;
}

// Of a RAW cloud that is valid.
bool IsDense(const v1::PointCloud& cloud) {
  const absl::StatusOr<Scan> scan = DecodeScan(cloud.header(), cloud.data(), kNoLimits);
  if (!scan.ok()) return false;
  return std::all_of(scan->points.begin(), scan->points.end(), [](const auto& point) { return point.allFinite(); });
}

absl::Status ValidateRosSizes(const RosPointCloud2& message) {
  if (message.is_bigendian) return FieldError("is_bigendian", "only little-endian points are taken");
  const uint64_t packed_row_bytes = uint64_t{message.width} * message.point_step;
  if (message.row_step < packed_row_bytes) {
    return FieldError("row_step", absl::StrCat(message.row_step, " bytes do not hold ", message.width, " points of ",
                                               message.point_step));
  }
  const uint64_t data_bytes = uint64_t{message.height} * message.row_step;
  if (message.data.size() == data_bytes) return absl::OkStatus();
  return FieldError("data", absl::StrCat("has ", message.data.size(), " bytes; rows take ", data_bytes));
}

// A field of several numbers as fields of one each.
void AddFoxgloveFields(const v1::PointField& field, FoxglovePointCloud& message) {
  const uint32_t count = CountOf(field);
  for (uint32_t i = 0; i < count; ++i) {
    FoxglovePackedField& added = message.fields.emplace_back();
    added.name = count == 1 ? field.name() : absl::StrCat(field.name(), "_", i);
    added.offset = field.offset() + i * NumericSize(field.type());
    added.type = SwapSign(field.type());
  }
}

void SetPose(const v1::RigidTransform& T, FoxglovePointCloud& message) {
  message.position[0] = T.translation().x();
  message.position[1] = T.translation().y();
  message.position[2] = T.translation().z();
  message.orientation[0] = T.rotation().x();
  message.orientation[1] = T.rotation().y();
  message.orientation[2] = T.rotation().z();
  message.orientation[3] = T.rotation().w();
}

v1::RigidTransform PoseOf(const FoxglovePointCloud& message) {
  v1::RigidTransform T;
  T.mutable_translation()->set_x(message.position[0]);
  T.mutable_translation()->set_y(message.position[1]);
  T.mutable_translation()->set_z(message.position[2]);
  T.mutable_rotation()->set_x(message.orientation[0]);
  T.mutable_rotation()->set_y(message.orientation[1]);
  T.mutable_rotation()->set_z(message.orientation[2]);
  T.mutable_rotation()->set_w(message.orientation[3]);
  return T;
}

bool IsIdentity(const FoxglovePointCloud& message) {
  const FoxglovePointCloud identity;
  return std::equal(message.position, message.position + 3, identity.position) &&
         std::equal(message.orientation, message.orientation + 4, identity.orientation);
}

}  // namespace

absl::StatusOr<v1::PointCloud> FromRos(const RosPointCloud2& message) {
  if (absl::Status status = ValidateRosSizes(message); !status.ok()) return status;
  v1::PointCloud cloud;
  v1::PointCloudHeader& header = *cloud.mutable_header();
  header.set_frame_id(message.frame_id);
  SetTime(message.stamp_sec, message.stamp_nanosec, header);
  header.set_point_count(uint64_t{message.width} * message.height);
  header.set_encoding(v1::POINT_ENCODING_RAW);
  v1::PointLayout& layout = *header.mutable_layout();
  layout.set_point_stride(message.point_step);
  for (const RosPointField& field : message.fields) {
    AddField(field.name, field.offset, field.datatype, field.count, layout);
  }
  const auto row_padding = static_cast<uint32_t>(message.row_step - uint64_t{message.width} * message.point_step);
  if (message.width != 0 && (message.height != 1 || row_padding != 0)) {
    layout.set_width(message.width);
    layout.set_row_padding(row_padding);
  }
  cloud.set_data(message.data);
  return Validated(std::move(cloud));
}

absl::StatusOr<v1::PointCloud> FromFoxglove(const FoxglovePointCloud& message) {
  if (message.point_stride == 0 || message.data.size() % message.point_stride != 0) {
    return FieldError("data",
                      absl::StrCat(message.data.size(), " bytes are not whole points of ", message.point_stride));
  }
  v1::PointCloud cloud;
  v1::PointCloudHeader& header = *cloud.mutable_header();
  header.set_frame_id(message.frame_id);
  SetTime(message.timestamp_sec, message.timestamp_nsec, header);
  header.set_point_count(message.data.size() / message.point_stride);
  header.set_encoding(v1::POINT_ENCODING_RAW);
  if (!IsIdentity(message)) *header.mutable_t_world_sensor() = PoseOf(message);
  v1::PointLayout& layout = *header.mutable_layout();
  layout.set_point_stride(message.point_stride);
  for (const FoxglovePackedField& field : message.fields) {
    AddField(field.name, field.offset, SwapSign(field.type), 1, layout);
  }
  cloud.set_data(message.data);
  return Validated(std::move(cloud));
}

absl::StatusOr<RosPointCloud2> ToRos(const v1::PointCloud& cloud) {
  absl::StatusOr<v1::PointCloud> raw = Unpacked(cloud);
  if (!raw.ok()) return raw.status();
  const v1::PointCloudHeader& header = raw->header();
  const v1::PointLayout& layout = header.layout();
  const uint64_t width = layout.width() == 0 ? header.point_count() : layout.width();
  const uint64_t height = layout.width() == 0 ? 1 : header.point_count() / width;
  const uint64_t row_step = width * layout.point_stride() + layout.row_padding();
  constexpr uint64_t kMax = std::numeric_limits<uint32_t>::max();
  if (row_step > kMax || height > kMax) return FieldError("header.layout", "more than ROS counts in 32 bits");
  const int64_t seconds = header.time().seconds();
  if (seconds != static_cast<int32_t>(seconds)) return FieldError("header.time", "ROS has 32 bits for the seconds");
  RosPointCloud2 message;
  message.stamp_sec = static_cast<int32_t>(seconds);
  message.stamp_nanosec = static_cast<uint32_t>(header.time().nanos());
  message.frame_id = header.frame_id();
  message.height = static_cast<uint32_t>(height);
  message.width = static_cast<uint32_t>(width);
  for (const v1::PointField& field : layout.fields()) {
    message.fields.push_back({field.name(), field.offset(), static_cast<uint8_t>(field.type()), CountOf(field)});
  }
  message.point_step = layout.point_stride();
  message.row_step = static_cast<uint32_t>(row_step);
  message.is_dense = IsDense(*raw);
  message.data = std::move(*raw->mutable_data());
  return message;
}

absl::StatusOr<FoxglovePointCloud> ToFoxglove(const v1::PointCloud& cloud) {
  absl::StatusOr<v1::PointCloud> raw = Unpacked(cloud);
  if (!raw.ok()) return raw.status();
  const v1::PointCloudHeader& header = raw->header();
  if (header.layout().row_padding() != 0) return FieldError("header.layout.row_padding", "foxglove has no rows");
  FoxglovePointCloud message;
  message.timestamp_sec = header.time().seconds();
  message.timestamp_nsec = static_cast<uint32_t>(header.time().nanos());
  message.frame_id = header.frame_id();
  if (header.has_t_world_sensor()) SetPose(header.t_world_sensor(), message);
  message.point_stride = header.layout().point_stride();
  for (const v1::PointField& field : header.layout().fields()) AddFoxgloveFields(field, message);
  message.data = std::move(*raw->mutable_data());
  return message;
}

}  // namespace curvereg::wire
