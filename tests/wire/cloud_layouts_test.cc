// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Clouds as drivers pack them: other fields beside the positions, rows, padding.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "tests/testing/matchers.h"
#include "wire/byte_shuffle.h"
#include "wire/error.h"
#include "wire/point_codec.h"
#include "wire/point_layout.h"
#include "wire/zstd_frame.h"

namespace curvereg::wire {
namespace {

using ::curvereg::testing::IsOk;

constexpr size_t kNumPoints = 600;
constexpr uint32_t kStride = 29;

// Coordinate `axis` of point `i`: exact in float32.
double Coordinate(size_t i, size_t axis) { return 0.25 * static_cast<double>(i) - 10.0 * static_cast<double>(axis); }

// z, a byte, x, y, the rest unused, at odd offsets; rows of `width` points (0: none) with `row_padding` bytes after.
v1::PointCloud Cloud(v1::NumericType type, uint32_t width, uint32_t row_padding) {
  v1::PointCloud cloud;
  cloud.mutable_header()->set_point_count(kNumPoints);
  cloud.mutable_header()->set_encoding(v1::POINT_ENCODING_RAW);
  v1::PointLayout& layout = *cloud.mutable_header()->mutable_layout();
  layout.set_point_stride(kStride);
  layout.set_width(width);
  layout.set_row_padding(row_padding);
  const uint32_t size = NumericSize(type);
  const uint32_t offsets[] = {size + 1, 2 * size + 1, 0};
  for (size_t axis = 0; axis < 3; ++axis) {
    v1::PointField* field = layout.add_fields();
    field->set_name(std::string(1, "xyz"[axis]));
    field->set_offset(offsets[axis]);
    field->set_type(type);
  }
  std::string block(LayoutBytes(layout, kNumPoints), '\x5A');
  for (size_t i = 0; i < kNumPoints; ++i) {
    for (size_t axis = 0; axis < 3; ++axis) {
      char* out = block.data() + i * kStride + (width == 0 ? 0 : i / width * row_padding) + offsets[axis];
      const double coordinate = Coordinate(i, axis);
      const auto narrow = static_cast<float>(coordinate);
      std::memcpy(out, size == 8 ? static_cast<const void*>(&coordinate) : &narrow, size);
    }
  }
  cloud.set_data(block);
  return cloud;
}

v1::PointCloud Shuffled(v1::PointCloud cloud) {
  std::string planes(cloud.data().size(), '\0');
  ShuffleBytes(cloud.data(), kStride, planes.data());
  cloud.mutable_header()->set_encoding(v1::POINT_ENCODING_SHUFFLED_ZSTD);
  cloud.set_data(*CompressFrame(planes, 1));
  return cloud;
}

void ExpectThePoints(const v1::PointCloud& cloud) {
  const absl::StatusOr<Scan> scan = DecodeScan(cloud.header(), cloud.data(), {});
  ASSERT_THAT(scan, IsOk());
  ASSERT_EQ(scan->points.size(), kNumPoints);
  for (size_t i = 0; i < kNumPoints; ++i) {
    const Eigen::Vector3d expected(Coordinate(i, 0), Coordinate(i, 1), Coordinate(i, 2));
    ASSERT_EQ(scan->points[i], expected.cast<float>()) << "point " << i;
  }
}

TEST(CloudLayoutsTest, PositionsAreFoundInEveryLayout) {
  for (const auto type : {v1::NUMERIC_TYPE_FLOAT32, v1::NUMERIC_TYPE_FLOAT64}) {
    for (const uint32_t width : {0U, 1U, 30U, 600U}) {
      SCOPED_TRACE(width);
      ExpectThePoints(Cloud(type, width, 0));
      ExpectThePoints(Shuffled(Cloud(type, width, 0)));
      if (width != 0) ExpectThePoints(Cloud(type, width, 7));
    }
  }
}

TEST(CloudLayoutsTest, BlocksComeBackWithAllFields) {
  const v1::PointCloud cloud = Cloud(v1::NUMERIC_TYPE_FLOAT64, 30, 0);
  for (const v1::PointCloud& encoded : {cloud, Shuffled(cloud)}) {
    const absl::StatusOr<std::string> block = DecodeBlock(encoded.header(), encoded.data(), {});
    ASSERT_THAT(block, IsOk());
    EXPECT_EQ(*block, cloud.data());
  }
  PointEncodingOptions options;
  options.encoding = v1::POINT_ENCODING_QUANTIZED_ZSTD;
  const v1::PointCloud quantized = *EncodeScan(Scan{{{1.0F, 2.0F, 3.0F}}, std::nullopt}, options);
  const absl::Status status = DecodeBlock(quantized.header(), quantized.data(), {}).status();
  EXPECT_EQ(BadRequestOf(status)->field_violations(0).field(), "encoding");
}

TEST(CloudLayoutsTest, OneByteTooManyOrTooFewIsRefused) {
  for (const int change : {-1, 1}) {
    v1::PointCloud cloud = Cloud(v1::NUMERIC_TYPE_FLOAT32, 30, 7);
    cloud.mutable_data()->resize(static_cast<size_t>(static_cast<int>(cloud.data().size()) + change));
    EXPECT_EQ(ReasonOf(DecodeScan(cloud.header(), cloud.data(), {}).status()), v1::ERROR_REASON_INVALID_FIELD);
    cloud = Shuffled(Cloud(v1::NUMERIC_TYPE_FLOAT32, 30, 0));
    cloud.mutable_data()->resize(static_cast<size_t>(static_cast<int>(cloud.data().size()) + change));
    EXPECT_EQ(ReasonOf(DecodeScan(cloud.header(), cloud.data(), {}).status()), v1::ERROR_REASON_MALFORMED_PAYLOAD);
  }
}

TEST(CloudLayoutsTest, ThePayloadMustHoldExactlyThePointsOfTheHeader) {
  v1::PointCloud cloud = Shuffled(Cloud(v1::NUMERIC_TYPE_FLOAT32, 0, 0));
  for (const uint64_t count : {kNumPoints - 1, kNumPoints + 1, size_t{0}, size_t{2000}}) {
    cloud.mutable_header()->set_point_count(count);
    EXPECT_EQ(ReasonOf(DecodeScan(cloud.header(), cloud.data(), {}).status()), v1::ERROR_REASON_MALFORMED_PAYLOAD);
  }
}

}  // namespace
}  // namespace curvereg::wire
