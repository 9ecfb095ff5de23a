// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/sensor_messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>
#include <string>

#include "absl/strings/str_cat.h"
#include "tests/testing/matchers.h"
#include "wire/byte_shuffle.h"
#include "wire/error.h"
#include "wire/point_codec.h"
#include "wire/zstd_frame.h"

namespace curvereg::wire {
namespace {

using ::curvereg::testing::IsOk;

// `num_points` points of `stride` bytes that begin with x y z, `row_padding` bytes after each row of `width`.
std::string Block(size_t num_points, size_t stride, size_t width, size_t row_padding) {
  std::string block;
  for (size_t i = 0; i < num_points; ++i) {
    std::string point(stride, static_cast<char>(i));
    const float xyz[] = {static_cast<float>(i), 0.5F, -2.0F};
    std::memcpy(point.data(), xyz, sizeof(xyz));
    block += point;
    if (i % width == width - 1) block += std::string(row_padding, '\x7E');
  }
  return block;
}

// As an organised lidar's driver publishes it: 2 rows of 3 points.
RosPointCloud2 RosMessage() {
  RosPointCloud2 message;
  message.stamp_sec = 1'700'000'000;
  message.stamp_nanosec = 123'456'789;
  message.frame_id = "os_sensor";
  message.height = 2;
  message.width = 3;
  message.fields = {{"x", 0, 7, 1},  {"y", 4, 7, 1},       {"z", 8, 7, 1},
                    {"t", 12, 6, 1}, {"signal", 16, 4, 2}, {"flag", 20, 1, 1}};
  message.point_step = 21;
  message.row_step = 3 * 21 + 5;
  message.data = Block(6, 21, 3, 5);
  message.is_dense = true;
  return message;
}

FoxglovePointCloud FoxgloveMessage() {
  FoxglovePointCloud message;
  message.timestamp_sec = 1'700'000'000;
  message.timestamp_nsec = 5;
  message.frame_id = "map";
  message.position[0] = 1.5;
  message.orientation[2] = 1.0;
  message.orientation[3] = 0.0;
  message.point_stride = 20;
  message.fields = {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}, {"ring", 12, 3}, {"dt", 14, 6}};
  message.data = Block(4, 20, 4, 0);
  return message;
}

TEST(SensorMessagesTest, RosMessagesComeBackAsTheyWere) {
  const RosPointCloud2 organised = RosMessage();
  RosPointCloud2 packed = organised;
  packed.height = 1;
  packed.width = 6;
  packed.row_step = 6 * 21;
  packed.data = Block(6, 21, 6, 0);
  RosPointCloud2 unstamped = packed;
  unstamped.stamp_sec = 0;
  unstamped.stamp_nanosec = 0;
  RosPointCloud2 column = packed;
  column.width = 1;
  column.height = 6;
  column.row_step = 21;
  RosPointCloud2 empty = packed;
  empty.width = 0;
  empty.row_step = 0;
  empty.data.clear();
  RosPointCloud2 doubles = packed;
  doubles.fields = {{"z", 0, 8, 1}, {"x", 8, 8, 1}, {"y", 16, 8, 1}};
  doubles.point_step = 24;
  doubles.row_step = 6 * 24;
  doubles.data.assign(6 * 24, '\0');
  for (const RosPointCloud2& message : {organised, packed, unstamped, column, empty, doubles}) {
    const absl::StatusOr<v1::PointCloud> cloud = FromRos(message);
    ASSERT_THAT(cloud, IsOk());
    EXPECT_EQ(cloud->header().has_time(), message.stamp_sec != 0);
    const absl::StatusOr<RosPointCloud2> back = ToRos(*cloud);
    ASSERT_THAT(back, IsOk());
    EXPECT_EQ(*back, message);
  }
}

TEST(SensorMessagesTest, RosPointsAreFound) {
  const absl::StatusOr<v1::PointCloud> cloud = FromRos(RosMessage());
  ASSERT_THAT(cloud, IsOk());
  EXPECT_EQ(cloud->header().layout().row_padding(), 5U);
  EXPECT_EQ(cloud->header().layout().fields(4).type(), v1::NUMERIC_TYPE_UINT16);
  const absl::StatusOr<Scan> scan = DecodeScan(cloud->header(), cloud->data(), {});
  ASSERT_THAT(scan, IsOk());
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(scan->points[static_cast<size_t>(i)], Eigen::Vector3f(static_cast<float>(i), 0.5F, -2.0F));
  }
}

TEST(SensorMessagesTest, DenseMeansThatAllPointsAreFinite) {
  RosPointCloud2 message = RosMessage();
  const float infinity = std::numeric_limits<float>::infinity();
  std::memcpy(message.data.data() + message.row_step + 2 * message.point_step + 4, &infinity, sizeof(infinity));
  EXPECT_FALSE(ToRos(*FromRos(message))->is_dense);
  message.is_dense = false;  // what came is not believed
  message.data = RosMessage().data;
  EXPECT_TRUE(ToRos(*FromRos(message))->is_dense);
}

// The field that FromRos blames after the change.
std::string Blamed(const std::function<void(RosPointCloud2&)>& change) {
  RosPointCloud2 message = RosMessage();
  change(message);
  const absl::Status status = FromRos(message).status();
  EXPECT_EQ(ReasonOf(status), v1::ERROR_REASON_INVALID_FIELD) << status;
  return status.ok() ? "" : BadRequestOf(status)->field_violations(0).field();
}

TEST(SensorMessagesTest, RefusesRosMessagesThatDoNotAgree) {
  EXPECT_EQ(Blamed([](auto& message) { message.is_bigendian = true; }), "is_bigendian");
  EXPECT_EQ(Blamed([](auto& message) { message.row_step = 62; }), "row_step");
  EXPECT_EQ(Blamed([](auto& message) { message.width = 0xFFFFFFFF; }), "row_step");
  EXPECT_EQ(Blamed([](auto& message) { message.data.pop_back(); }), "data");
  EXPECT_EQ(Blamed([](auto& message) { message.height = 0xFFFFFFFF; }), "data");
  EXPECT_EQ(Blamed([](auto& message) { message.fields[3].datatype = 9; }), "header.layout.fields[3].type");
  EXPECT_EQ(Blamed([](auto& message) { message.fields[3].datatype = 0; }), "header.layout.fields[3].type");
  EXPECT_EQ(Blamed([](auto& message) { message.fields[5].offset = 21; }), "header.layout.fields[5].offset");
  EXPECT_EQ(Blamed([](auto& message) { message.fields.erase(message.fields.begin()); }), "header.layout.fields");
  EXPECT_EQ(Blamed([](auto& message) { message.stamp_nanosec = 1'000'000'000; }), "header.time");
  EXPECT_EQ(Blamed([](auto& message) { message.stamp_nanosec = 0xFFFFFFFF; }), "header.time");
  EXPECT_EQ(Blamed([](auto& message) { message.frame_id = std::string(1, '\xFF'); }), "header.frame_id");
  EXPECT_EQ(Blamed([](auto& message) {
              message.point_step = 0;
              message.row_step = 0;
              message.data.clear();
            }),
            "header.layout.point_stride");
}

TEST(SensorMessagesTest, FoxgloveMessagesComeBackAsTheyWere) {
  const FoxglovePointCloud posed = FoxgloveMessage();
  FoxglovePointCloud plain = posed;
  plain.position[0] = 0.0;
  plain.orientation[2] = 0.0;
  plain.orientation[3] = 1.0;
  plain.timestamp_sec = 0;
  plain.timestamp_nsec = 0;
  FoxglovePointCloud empty = posed;
  empty.data.clear();
  for (const FoxglovePointCloud& message : {posed, plain, empty}) {
    const absl::StatusOr<v1::PointCloud> cloud = FromFoxglove(message);
    ASSERT_THAT(cloud, IsOk());
    const absl::StatusOr<FoxglovePointCloud> back = ToFoxglove(*cloud);
    ASSERT_THAT(back, IsOk());
    EXPECT_EQ(*back, message);
  }
  EXPECT_FALSE(FromFoxglove(plain)->header().has_t_world_sensor());
  EXPECT_EQ(FromFoxglove(posed)->header().t_world_sensor().rotation().z(), 1.0);
}

TEST(SensorMessagesTest, FoxgloveTypesHaveTheirOwnNumbers) {
  FoxglovePointCloud message = FoxgloveMessage();
  message.point_stride = 12 + 2 * (1 + 2 + 4) + 4 + 8;
  message.data.assign(message.point_stride, '\0');
  message.fields.resize(3);
  const uint32_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  const v1::NumericType types[] = {v1::NUMERIC_TYPE_UINT8,   v1::NUMERIC_TYPE_INT8,   v1::NUMERIC_TYPE_UINT16,
                                   v1::NUMERIC_TYPE_INT16,   v1::NUMERIC_TYPE_UINT32, v1::NUMERIC_TYPE_INT32,
                                   v1::NUMERIC_TYPE_FLOAT32, v1::NUMERIC_TYPE_FLOAT64};
  uint32_t offset = 12;
  for (int type = 1; type <= 8; ++type) {
    message.fields.push_back({absl::StrCat("f", type), offset, type});
    offset += sizes[type - 1];
  }
  const absl::StatusOr<v1::PointCloud> cloud = FromFoxglove(message);
  ASSERT_THAT(cloud, IsOk());
  for (int i = 0; i < 8; ++i) EXPECT_EQ(cloud->header().layout().fields(3 + i).type(), types[i]);
  EXPECT_EQ(*ToFoxglove(*cloud), message);
  for (const int type : {0, -1, 9}) {
    message.fields[5].type = type;
    EXPECT_EQ(BadRequestOf(FromFoxglove(message).status())->field_violations(0).field(),
              "header.layout.fields[5].type");
  }
}

TEST(SensorMessagesTest, RefusesFoxgloveMessagesThatDoNotAgree) {
  FoxglovePointCloud message = FoxgloveMessage();
  message.data.pop_back();
  EXPECT_EQ(BadRequestOf(FromFoxglove(message).status())->field_violations(0).field(), "data");
  message = FoxgloveMessage();
  message.point_stride = 0;
  EXPECT_EQ(BadRequestOf(FromFoxglove(message).status())->field_violations(0).field(), "data");
  message = FoxgloveMessage();
  message.orientation[2] = 0.5;
  EXPECT_EQ(BadRequestOf(FromFoxglove(message).status())->field_violations(0).field(),
            "header.t_world_sensor.rotation");
}

TEST(SensorMessagesTest, FoxgloveGetsNoRowsAndNoArrays) {
  const v1::PointCloud cloud = *FromRos(RosMessage());
  EXPECT_EQ(BadRequestOf(ToFoxglove(cloud).status())->field_violations(0).field(), "header.layout.row_padding");
  RosPointCloud2 packed = RosMessage();
  packed.row_step = 3 * 21;
  packed.data = Block(6, 21, 3, 0);
  const absl::StatusOr<FoxglovePointCloud> message = ToFoxglove(*FromRos(packed));
  ASSERT_THAT(message, IsOk());
  ASSERT_EQ(message->fields.size(), 7U);
  EXPECT_EQ(message->fields[4], (FoxglovePackedField{"signal_0", 16, 3}));
  EXPECT_EQ(message->fields[5], (FoxglovePackedField{"signal_1", 18, 3}));
  EXPECT_EQ(message->data, packed.data);
}

TEST(SensorMessagesTest, CompressedCloudsAreUnpackedFirst) {
  RosPointCloud2 message = RosMessage();
  message.row_step = 3 * 21;
  message.data = Block(6, 21, 3, 0);
  v1::PointCloud cloud = *FromRos(message);
  std::string planes(cloud.data().size(), '\0');
  ShuffleBytes(cloud.data(), 21, planes.data());
  cloud.set_data(*CompressFrame(planes, 1));
  cloud.mutable_header()->set_encoding(v1::POINT_ENCODING_SHUFFLED_ZSTD);
  EXPECT_EQ(*ToRos(cloud), message) << "other fields, too";

  PointEncodingOptions options;
  options.encoding = v1::POINT_ENCODING_QUANTIZED_ZSTD;
  v1::PointCloud quantized = *EncodeScan(Scan{{{1.0F, 2.0F, 3.0F}, {4.0F, 5.0F, 6.0F}}, std::nullopt}, options);
  quantized.mutable_header()->set_frame_id("lidar");
  quantized.mutable_header()->mutable_time()->set_seconds(77);
  quantized.mutable_header()->mutable_t_world_sensor()->mutable_translation()->set_y(8.0);
  quantized.mutable_header()->mutable_t_world_sensor()->mutable_rotation()->set_w(1.0);
  const absl::StatusOr<FoxglovePointCloud> foxglove = ToFoxglove(quantized);
  ASSERT_THAT(foxglove, IsOk());
  EXPECT_EQ(foxglove->frame_id, "lidar");
  EXPECT_EQ(foxglove->timestamp_sec, 77);
  EXPECT_EQ(foxglove->position[1], 8.0);
  ASSERT_EQ(foxglove->data.size(), 24U);
  float x = 0.0F;
  std::memcpy(&x, foxglove->data.data() + 12, sizeof(x));
  EXPECT_NEAR(x, 4.0F, 1e-3);
}

TEST(SensorMessagesTest, ErrorsNameTheFieldOfTheCloud) {
  v1::PointCloud cloud = *FromRos(RosMessage());
  cloud.mutable_header()->mutable_time()->set_seconds(int64_t{1} << 31);
  EXPECT_EQ(BadRequestOf(ToRos(cloud).status())->field_violations(0).field(), "header.time");
  EXPECT_THAT(ToFoxglove(*FromFoxglove(FoxgloveMessage())), IsOk());
  cloud.mutable_header()->clear_layout();
  EXPECT_EQ(BadRequestOf(ToRos(cloud).status())->field_violations(0).field(), "header.layout");
  cloud = *EncodeScan(Scan{{{1.0F, 2.0F, 3.0F}}, std::nullopt}, {.encoding = v1::POINT_ENCODING_SHUFFLED_ZSTD});
  cloud.mutable_data()->pop_back();
  EXPECT_EQ(ReasonOf(ToRos(cloud).status()), v1::ERROR_REASON_MALFORMED_PAYLOAD);
  EXPECT_EQ(ReasonOf(ToFoxglove(v1::PointCloud()).status()), v1::ERROR_REASON_INVALID_FIELD);
}

}  // namespace
}  // namespace curvereg::wire
