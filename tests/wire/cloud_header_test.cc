// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/cloud_header.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "tests/testing/matchers.h"
#include "wire/error.h"
#include "wire/point_layout.h"

namespace curvereg::wire {
namespace {

using ::curvereg::testing::IsOk;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

v1::PointCloudHeader RawHeader() {
  v1::PointCloudHeader header;
  header.set_frame_id("lidar");
  header.mutable_time()->set_seconds(1'700'000'000);
  header.set_point_count(100);
  header.set_encoding(v1::POINT_ENCODING_RAW);
  *header.mutable_layout() = PackedFloatLayout();
  header.mutable_gravity()->set_z(-1.6);
  header.mutable_t_world_sensor()->mutable_translation()->set_x(3.0);
  header.mutable_t_world_sensor()->mutable_rotation()->set_w(1.0);
  return header;
}

v1::PointCloudHeader QuantizedHeader() {
  v1::PointCloudHeader header = RawHeader();
  header.set_encoding(v1::POINT_ENCODING_QUANTIZED_ZSTD);
  header.clear_layout();
  header.mutable_quantization()->set_step_m(1e-3);
  header.mutable_quantization()->set_bytes_per_coordinate(3);
  header.mutable_quantization()->set_max_error_m(0.5 * std::sqrt(3.0) * 1e-3);
  return header;
}

constexpr uint64_t kPayloadBytes = 1200;  // what 100 packed points take

// The field that the error names; "" for a header that is valid, the reason where it is not INVALID_FIELD.
std::string Blamed(const v1::PointCloudHeader& header, uint64_t payload_bytes = kPayloadBytes,
                   const PointLimits& limits = {}) {
  const absl::Status status = ValidateHeader(header, payload_bytes, limits);
  if (status.ok()) return "";
  const auto bad_request = BadRequestOf(status);
  return bad_request.has_value() ? bad_request->field_violations(0).field() : ReasonName(*ReasonOf(status));
}

using Change = std::function<void(v1::PointCloudHeader&)>;

std::string BlamedAfter(v1::PointCloudHeader header, const Change& change) {
  change(header);
  return Blamed(header);
}

TEST(CloudHeaderTest, TakesWhatIsInOrder) {
  EXPECT_THAT(ValidateHeader(RawHeader(), kPayloadBytes, {}), IsOk());
  EXPECT_THAT(ValidateHeader(QuantizedHeader(), 50, {}), IsOk());
  v1::PointCloudHeader bare = RawHeader();
  bare.clear_frame_id();
  bare.clear_time();
  bare.clear_gravity();
  bare.clear_t_world_sensor();
  EXPECT_THAT(ValidateHeader(bare, kPayloadBytes, {}), IsOk());
}

TEST(CloudHeaderTest, NamesTheFieldOfTheDescription) {
  const v1::PointCloudHeader good = RawHeader();
  EXPECT_EQ(BlamedAfter(good, [](auto& header) { header.set_frame_id(std::string(129, 'f')); }), "frame_id");
  EXPECT_EQ(BlamedAfter(good, [](auto& header) { header.set_frame_id("a\tb"); }), "frame_id");
  EXPECT_EQ(BlamedAfter(good, [](auto& header) { header.mutable_time()->set_nanos(-1); }), "time");
  EXPECT_EQ(BlamedAfter(good, [](auto& header) { header.mutable_time()->set_nanos(1'000'000'000); }), "time");
  EXPECT_EQ(BlamedAfter(good, [](auto& header) { header.mutable_time()->set_seconds(253'402'300'800); }), "time");
  EXPECT_EQ(BlamedAfter(good, [](auto& header) { header.mutable_time()->set_seconds(-62'135'596'801); }), "time");
  EXPECT_EQ(BlamedAfter(good, [](auto& header) { header.mutable_gravity()->set_z(0.0); }), "gravity");
  EXPECT_EQ(BlamedAfter(good, [](auto& header) { header.mutable_gravity()->set_y(kInfinity); }), "gravity");
  EXPECT_EQ(BlamedAfter(good, [](auto& header) { header.mutable_gravity()->set_x(std::nan("")); }), "gravity");
  const auto turn = [](double w) {
    return [w](v1::PointCloudHeader& header) { header.mutable_t_world_sensor()->mutable_rotation()->set_w(w); };
  };
  EXPECT_EQ(BlamedAfter(good, turn(1.009)), "");
  EXPECT_EQ(BlamedAfter(good, turn(1.011)), "t_world_sensor.rotation");
  EXPECT_EQ(BlamedAfter(good, turn(std::nan(""))), "t_world_sensor.rotation");
}

TEST(CloudHeaderTest, NamesTheFieldOfThePacking) {
  const v1::PointCloudHeader raw = RawHeader();
  EXPECT_EQ(BlamedAfter(raw, [](auto& header) { header.clear_encoding(); }), "encoding");
  EXPECT_EQ(BlamedAfter(raw, [](auto& header) { header.set_encoding(static_cast<v1::PointEncoding>(9)); }), "encoding");
  EXPECT_EQ(BlamedAfter(raw, [](auto& header) { header.clear_layout(); }), "layout");
  EXPECT_EQ(BlamedAfter(raw, [](auto& header) { header.mutable_quantization(); }), "quantization");
  EXPECT_EQ(BlamedAfter(raw, [](auto& header) { header.mutable_layout()->mutable_fields(1)->set_name("x"); }),
            "layout.fields[1].name");
  EXPECT_EQ(BlamedAfter(raw,
                        [](auto& header) {
                          header.set_encoding(v1::POINT_ENCODING_SHUFFLED_ZSTD);
                          header.mutable_layout()->set_width(10);
                          header.mutable_layout()->set_row_padding(4);
                        }),
            "layout.row_padding");
}

TEST(CloudHeaderTest, NamesTheFieldOfTheQuantization) {
  const v1::PointCloudHeader good = QuantizedHeader();
  EXPECT_EQ(BlamedAfter(good, [](auto& header) { header.clear_quantization(); }), "quantization");
  EXPECT_EQ(BlamedAfter(good, [](auto& header) { *header.mutable_layout() = PackedFloatLayout(); }), "layout");
  const auto change = [&good](const std::function<void(v1::Quantization&)>& edit) {
    return BlamedAfter(good, [&edit](v1::PointCloudHeader& header) { edit(*header.mutable_quantization()); });
  };
  for (const double step : {0.0, -1.0, kInfinity, std::nan("")}) {
    EXPECT_EQ(change([step](auto& quantization) { quantization.set_step_m(step); }), "quantization.step_m") << step;
  }
  for (const uint32_t bytes : {0U, 1U, 5U, 0xFFFFFFFFU}) {
    EXPECT_EQ(change([bytes](auto& quantization) { quantization.set_bytes_per_coordinate(bytes); }),
              "quantization.bytes_per_coordinate");
  }
  for (const double error : {0.0, 0.8e-3, kInfinity, std::nan("")}) {
    EXPECT_EQ(change([error](auto& quantization) { quantization.set_max_error_m(error); }), "quantization.max_error_m");
  }
  EXPECT_EQ(change([](auto& quantization) { quantization.mutable_origin()->set_y(-kInfinity); }),
            "quantization.origin");
}

TEST(CloudHeaderTest, LimitsAreMetBeforeAllElse) {
  PointLimits limits;
  limits.max_points = 99;
  const absl::Status status = ValidateHeader(RawHeader(), kPayloadBytes, limits);
  EXPECT_EQ(ReasonOf(status), v1::ERROR_REASON_SCAN_TOO_LARGE);
  EXPECT_EQ(ErrorInfoOf(status)->metadata().at("limit"), "99");
  EXPECT_EQ(ErrorInfoOf(status)->metadata().at("value"), "100");
  limits = {.max_points = 100, .max_payload_bytes = kPayloadBytes - 1};
  EXPECT_EQ(Blamed(RawHeader(), kPayloadBytes, limits), "SCAN_TOO_LARGE");
  v1::PointCloudHeader shuffled = RawHeader();
  shuffled.set_encoding(v1::POINT_ENCODING_SHUFFLED_ZSTD);
  EXPECT_EQ(Blamed(shuffled, 100, limits), "SCAN_TOO_LARGE") << "the block that it decompresses to";
  limits.max_payload_bytes = kPayloadBytes;
  EXPECT_EQ(Blamed(shuffled, 100, limits), "");
}

TEST(CloudHeaderTest, CountsThatOverflowAreTooLarge) {
  constexpr uint64_t kMax = std::numeric_limits<uint64_t>::max();
  const PointLimits limits{.max_points = kMax, .max_payload_bytes = kMax - 1};
  for (v1::PointCloudHeader header : {RawHeader(), QuantizedHeader()}) {
    for (const uint64_t count : {kMax, kMax / 2, kMax / 9 + 1, (uint64_t{1} << 62) + 100}) {
      header.set_point_count(count);
      EXPECT_EQ(Blamed(header, kPayloadBytes, limits), "SCAN_TOO_LARGE") << count;
    }
  }
}

TEST(CloudHeaderTest, ThePayloadMustBeAbleToHoldThePoints) {
  EXPECT_EQ(Blamed(RawHeader(), kPayloadBytes - 1), "point_count");
  EXPECT_EQ(Blamed(RawHeader(), kPayloadBytes + 1), "point_count");
  v1::PointCloudHeader header = QuantizedHeader();
  header.set_point_count(50'000'000);
  EXPECT_EQ(Blamed(header, 4000), "point_count") << "more than zstd can hold in 4000 bytes";
  EXPECT_EQ(Blamed(header, 50'000'000 * 9 / kMaxZstdRatio), "");
}

}  // namespace
}  // namespace curvereg::wire
