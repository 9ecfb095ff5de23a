// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/quantization.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "tests/testing/matchers.h"
#include "wire/error.h"

namespace curvereg::wire {
namespace {

using ::curvereg::testing::IsOk;
using Points = std::vector<Eigen::Vector3f>;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

v1::Quantization Millimetres(uint32_t bytes) {
  v1::Quantization quantization;
  quantization.mutable_origin()->set_x(-1.0);
  quantization.mutable_origin()->set_z(2.0);
  quantization.set_step_m(1e-3);
  quantization.set_bytes_per_coordinate(bytes);
  return quantization;
}

TEST(QuantizationTest, WritesTheIntegersByPlanes) {
  const Points points = {{-1.0F, 0.001F, 2.258F}, {kNan, 1.0F, 3.0F}, {-0.9F, 0.0F, 67.534F}};
  std::string planes(3 * 2 * points.size(), '?');
  QuantizePoints(points, Millimetres(2), planes.data());
  //                      x low         x high        y low         y high        z low         z high
  EXPECT_EQ(planes, std::string("\x00\xFF\x64"
                                "\x00\xFF\x00"
                                "\x01\xFF\x00"
                                "\x00\xFF\x00"
                                "\x02\xFF\xFE"
                                "\x01\xFF\xFF",
                                18));
}

TEST(QuantizationTest, ReadsIntegersOfEverySize) {
  for (const uint32_t bytes : {2U, 3U, 4U}) {
    // Integers 513, 1 and 0; then the mark on x alone; then the greatest integers that are none.
    Points points(3);
    std::string planes(9 * bytes, '\0');
    const auto set = [&](size_t point, size_t axis, uint64_t integer) {
      for (size_t k = 0; k < bytes; ++k) planes[(axis * bytes + k) * 3 + point] = static_cast<char>(integer >> (8 * k));
    };
    const uint64_t greatest = (uint64_t{1} << (8 * bytes)) - 1;
    set(0, 0, 513);
    set(0, 1, 1);
    set(1, 0, greatest);
    set(2, 0, greatest - 1);
    set(2, 1, greatest);
    DequantizePoints(planes, Millimetres(bytes), points);
    EXPECT_EQ(points[0], Eigen::Vector3f(static_cast<float>(-1.0 + 0.513), 0.001F, 2.0F));
    EXPECT_TRUE(points[1].array().isNaN().all()) << bytes;
    EXPECT_EQ(points[2].x(), static_cast<float>(-1.0 + 1e-3 * static_cast<double>(greatest - 1)));
    EXPECT_EQ(points[2].y(), static_cast<float>(1e-3 * static_cast<double>(greatest)));
  }
}

TEST(QuantizationTest, CoordinatesBeyondFloatBecomeNoReturn) {
  v1::Quantization quantization = Millimetres(2);
  quantization.set_step_m(1e36);
  Points points(1);
  DequantizePoints(std::string("\x01\0\0\x7F\0\0", 6), quantization, points);
  EXPECT_EQ(points[0].x(), 1e36F);
  EXPECT_TRUE(std::isnan(points[0].y())) << points[0].y();
}

TEST(QuantizationTest, ChoosesTheLeastCornerForItsOrigin) {
  const Points points = {{1.0F, 5.0F, -3.0F}, {-2.0F, 9.0F, 4.0F}, {kNan, -100.0F, -100.0F}};
  const absl::StatusOr<v1::Quantization> quantization = ChooseQuantization(points, 0.01);
  ASSERT_THAT(quantization, IsOk());
  EXPECT_EQ(quantization->origin().x(), -2.0);
  EXPECT_EQ(quantization->origin().y(), 5.0);
  EXPECT_EQ(quantization->origin().z(), -3.0);
  EXPECT_EQ(quantization->max_error_m(), 0.01);
  EXPECT_NEAR(quantization->step_m(), 0.02 / std::sqrt(3.0), 1e-5);
  EXPECT_EQ(quantization->bytes_per_coordinate(), 2U);
}

TEST(QuantizationTest, RefusesPromisesThatItCannotKeep) {
  const Points huge = {{-3e38F, 0.0F, 0.0F}, {3e38F, 0.0F, 0.0F}};
  const absl::Status status = ChooseQuantization(huge, 1e-3).status();
  EXPECT_EQ(ReasonOf(status), v1::ERROR_REASON_INVALID_FIELD);
  EXPECT_EQ(BadRequestOf(status)->field_violations(0).field(), "max_error_m");
  EXPECT_THAT(ChooseQuantization(huge, 1e30), IsOk());
  EXPECT_FALSE(ChooseQuantization({}, 0.0).ok());
  EXPECT_FALSE(ChooseQuantization({}, std::numeric_limits<double>::max()).ok()) << "a step that is not finite";
  EXPECT_THAT(ChooseQuantization({}, 1e-3), IsOk());
}

}  // namespace
}  // namespace curvereg::wire
