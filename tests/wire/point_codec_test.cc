// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/point_codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "tests/testing/matchers.h"
#include "wire/error.h"
#include "wire/point_layout.h"
#include "wire/zstd_frame.h"

namespace curvereg::wire {
namespace {

using ::curvereg::testing::IsOk;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr v1::PointEncoding kEncodings[] = {v1::POINT_ENCODING_RAW, v1::POINT_ENCODING_SHUFFLED_ZSTD,
                                            v1::POINT_ENCODING_QUANTIZED_ZSTD};

// Points within half_extent_m of the centre on each axis; every `no_return_every`-th without a return (0: none).
Scan RandomScan(int num_points, Eigen::Vector3d center, double half_extent_m, int no_return_every, uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&random] { return static_cast<double>(random() >> 11) * 0x1p-52 - 1.0; };
  Scan scan;
  for (int i = 0; i < num_points; ++i) {
    const Eigen::Vector3d offset(uniform(), uniform(), uniform());
    scan.points.push_back((center + half_extent_m * offset).cast<float>());
    if (no_return_every != 0 && i % no_return_every == 0) scan.points.back()[i % 3] = kNan;
  }
  return scan;
}

absl::StatusOr<Scan> Decode(const v1::PointCloud& cloud) { return DecodeScan(cloud.header(), cloud.data(), {}); }

v1::PointCloud Encode(const Scan& scan, v1::PointEncoding encoding, double max_error_m = 1e-3) {
  PointEncodingOptions options;
  options.encoding = encoding;
  options.max_error_m = max_error_m;
  absl::StatusOr<v1::PointCloud> cloud = EncodeScan(scan, options);
  EXPECT_THAT(cloud, IsOk());
  return cloud.ok() ? *cloud : v1::PointCloud();
}

bool SameBits(const Scan& a, const Scan& b) {
  return a.points.size() == b.points.size() &&
         std::memcmp(a.points.data(), b.points.data(), a.points.size() * sizeof(Eigen::Vector3f)) == 0;
}

// The greatest distance of a decoded point from its original [m]; infinite where returns do not agree.
double GreatestError(const Scan& original, const Scan& decoded) {
  double greatest = 0.0;
  if (original.points.size() != decoded.points.size()) return std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < original.points.size(); ++i) {
    const bool is_return = original.points[i].allFinite();
    if (is_return != decoded.points[i].allFinite()) return std::numeric_limits<double>::infinity();
    if (!is_return) continue;
    const Eigen::Vector3d error = decoded.points[i].cast<double>() - original.points[i].cast<double>();
    greatest = std::max(greatest, error.norm());
  }
  return greatest;
}

TEST(PointCodecTest, LosslessEncodingsKeepEveryBit) {
  Scan scan = RandomScan(10'007, {3.0, -4.0, 0.5}, 80.0, 13, 1);
  scan.points[5].x() = -std::numeric_limits<float>::infinity();
  scan.points[6].y() = std::bit_cast<float>(0x7FC12345U);  // a not-a-number with a payload
  scan.gravity = Eigen::Vector3d(0.1, -0.2, -9.7);
  for (const auto encoding : {v1::POINT_ENCODING_RAW, v1::POINT_ENCODING_SHUFFLED_ZSTD}) {
    const v1::PointCloud cloud = Encode(scan, encoding);
    EXPECT_EQ(cloud.header().point_count(), scan.points.size());
    const absl::StatusOr<Scan> decoded = Decode(cloud);
    ASSERT_THAT(decoded, IsOk());
    EXPECT_TRUE(SameBits(scan, *decoded)) << encoding;
    EXPECT_EQ(decoded->gravity, scan.gravity);
  }
  EXPECT_EQ(Encode(scan, v1::POINT_ENCODING_RAW).data().size(), 12 * scan.points.size());
}

TEST(PointCodecTest, EveryEncodingTakesTheEmptyScanAndScansWithoutAReturn) {
  for (const auto encoding : kEncodings) {
    const absl::StatusOr<Scan> empty = Decode(Encode(Scan(), encoding));
    ASSERT_THAT(empty, IsOk()) << encoding;
    EXPECT_TRUE(empty->points.empty());
    EXPECT_FALSE(empty->gravity.has_value());
    Scan nothing;
    nothing.points.assign(5, Eigen::Vector3f::Constant(kNan));
    const absl::StatusOr<Scan> decoded = Decode(Encode(nothing, encoding));
    ASSERT_THAT(decoded, IsOk()) << encoding;
    ASSERT_EQ(decoded->points.size(), 5U);
    for (const Eigen::Vector3f& point : decoded->points) EXPECT_FALSE(point.allFinite());
  }
}

TEST(PointCodecTest, QuantizedPointsKeepThePromiseWhateverTheExtent) {
  uint64_t seed = 0;
  for (const double half_extent_m : {0.0, 1e-3, 0.1, 5.0, 70.0, 1000.0}) {
    for (const double center_m : {0.0, 10.0, -500.0, 90e3}) {
      for (const double max_error_m : {1e-5, 1e-4, 1e-3, 0.02, 3.0}) {
        const Scan scan = RandomScan(2000, {center_m, -center_m, 0.3 * center_m}, half_extent_m, 7, ++seed);
        const v1::PointCloud cloud = Encode(scan, v1::POINT_ENCODING_QUANTIZED_ZSTD, max_error_m);
        const absl::StatusOr<Scan> decoded = Decode(cloud);
        ASSERT_THAT(decoded, IsOk());
        EXPECT_LE(GreatestError(scan, *decoded), max_error_m)
            << half_extent_m << " m about " << center_m << " m to " << max_error_m << " m";
        EXPECT_EQ(cloud.header().quantization().max_error_m(), max_error_m);
      }
    }
  }
}

// Among many points some lie half a step off on each axis.
TEST(PointCodecTest, TheStepIsAsCoarseAsThePromiseAllows) {
  const Scan scan = RandomScan(200'000, Eigen::Vector3d::Zero(), 30.0, 0, 99);
  const v1::PointCloud cloud = Encode(scan, v1::POINT_ENCODING_QUANTIZED_ZSTD, 1e-3);
  const absl::StatusOr<Scan> decoded = Decode(cloud);
  ASSERT_THAT(decoded, IsOk());
  EXPECT_GT(GreatestError(scan, *decoded), 0.95e-3);
  EXPECT_GT(cloud.header().quantization().step_m(), 0.99 * 2e-3 / std::sqrt(3.0));
}

TEST(PointCodecTest, TakesTheFewestBytesThatFit) {
  const auto bytes = [](double half_extent_m, double max_error_m) {
    const Scan scan = RandomScan(500, Eigen::Vector3d::Zero(), half_extent_m, 0, 3);
    return Encode(scan, v1::POINT_ENCODING_QUANTIZED_ZSTD, max_error_m).header().quantization().bytes_per_coordinate();
  };
  EXPECT_EQ(bytes(30.0, 1e-3), 2U);
  EXPECT_EQ(bytes(100.0, 1e-3), 3U);
  EXPECT_EQ(bytes(1000.0, 1e-5), 4U);
  PointEncodingOptions options;
  options.encoding = v1::POINT_ENCODING_QUANTIZED_ZSTD;
  const Scan scan = RandomScan(500, Eigen::Vector3d::Zero(), 1000.0, 0, 3);
  for (const double max_error_m : {0.0, -1.0, 1e-9, 1e-320, std::numeric_limits<double>::infinity(), std::nan("")}) {
    options.max_error_m = max_error_m;
    EXPECT_EQ(ReasonOf(EncodeScan(scan, options).status()), v1::ERROR_REASON_INVALID_FIELD) << max_error_m;
  }
}

// The integers at both ends of the range, with the mark of a missing return beside them.
TEST(PointCodecTest, TheGreatestCoordinateIsNotTakenForAMissingReturn) {
  for (const float extent : {37.5F, 37.8F, 9600.0F}) {
    Scan scan;
    for (int i = 0; i < 4000; ++i) {
      scan.points.emplace_back(extent + 0.0005F * static_cast<float>(i), 0.0F, 0.0F);
      scan.points.emplace_back(-extent, 0.0F, 0.0F);
    }
    const absl::StatusOr<Scan> decoded = Decode(Encode(scan, v1::POINT_ENCODING_QUANTIZED_ZSTD));
    ASSERT_THAT(decoded, IsOk());
    EXPECT_LE(GreatestError(scan, *decoded), 1e-3);
  }
}

TEST(PointCodecTest, CoordinatesBeyondFloatBecomeNoReturn) {
  v1::PointCloudHeader header;
  header.set_encoding(v1::POINT_ENCODING_RAW);
  *header.mutable_layout() = PackedFloatLayout();
  header.mutable_layout()->set_point_stride(24);
  for (int axis = 0; axis < 3; ++axis) {
    header.mutable_layout()->mutable_fields(axis)->set_type(v1::NUMERIC_TYPE_FLOAT64);
    header.mutable_layout()->mutable_fields(axis)->set_offset(static_cast<uint32_t>(8 * axis));
  }
  header.set_point_count(2);
  const double coordinates[] = {1.5, -2.5, 1e300, 0.1, 0.2, 0.3};
  const absl::StatusOr<Scan> scan =
      DecodeScan(header, {reinterpret_cast<const char*>(coordinates), sizeof(coordinates)}, {});
  ASSERT_THAT(scan, IsOk());
  EXPECT_EQ(scan->points[0].head<2>(), Eigen::Vector2f(1.5F, -2.5F));
  EXPECT_TRUE(std::isnan(scan->points[0].z()));
  EXPECT_EQ(scan->points[1], Eigen::Vector3f(0.1F, 0.2F, 0.3F));
}

TEST(PointCodecTest, TheSameScanGivesTheSameBytes) {
  const Scan scan = RandomScan(5000, Eigen::Vector3d::Zero(), 50.0, 11, 8);
  for (const auto encoding : kEncodings) {
    EXPECT_EQ(Encode(scan, encoding).SerializeAsString(), Encode(scan, encoding).SerializeAsString());
  }
}

TEST(PointCodecTest, RefusesEncodingsThatItDoesNotKnow) {
  PointEncodingOptions options;
  options.encoding = v1::POINT_ENCODING_UNSPECIFIED;
  EXPECT_EQ(ReasonOf(EncodeScan(Scan(), options).status()), v1::ERROR_REASON_INVALID_FIELD);
}

}  // namespace
}  // namespace curvereg::wire
