// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/point_layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

#include "absl/strings/str_cat.h"
#include "tests/testing/matchers.h"
#include "wire/error.h"

namespace curvereg::wire {
namespace {

using ::curvereg::testing::IsOk;

v1::PointField* AddField(v1::PointLayout& layout, const std::string& name, uint32_t offset, v1::NumericType type) {
  v1::PointField* field = layout.add_fields();
  field->set_name(name);
  field->set_offset(offset);
  field->set_type(type);
  return field;
}

// As a spinning lidar's driver gives it: x y z, padding, intensity, time, ring.
v1::PointLayout LidarLayout() {
  v1::PointLayout layout = PackedFloatLayout();
  AddField(layout, "intensity", 16, v1::NUMERIC_TYPE_FLOAT32);
  AddField(layout, "t", 20, v1::NUMERIC_TYPE_FLOAT64);
  AddField(layout, "ring", 28, v1::NUMERIC_TYPE_UINT16);
  layout.set_point_stride(32);
  return layout;
}

// The field that the error names; "" for a layout that is valid.
std::string Blamed(const v1::PointLayout& layout, uint64_t point_count = 100) {
  const absl::Status status = ValidateLayout(layout, point_count);
  if (status.ok()) return "";
  return BadRequestOf(status)->field_violations(0).field();
}

std::string BlamedAfter(const std::function<void(v1::PointLayout&)>& change) {
  v1::PointLayout layout = LidarLayout();
  change(layout);
  return Blamed(layout);
}

TEST(PointLayoutTest, TakesThePackedFloatsAndALidarsFields) {
  EXPECT_THAT(ValidateLayout(PackedFloatLayout(), 7), IsOk());
  EXPECT_THAT(ValidateLayout(LidarLayout(), 7), IsOk());
  EXPECT_TRUE(IsPackedFloats(PackedFloatLayout()));
  EXPECT_FALSE(IsPackedFloats(LidarLayout()));
  v1::PointLayout overlapping = LidarLayout();  // a bit field seen in two ways, away from x y z
  AddField(overlapping, "ring_low", 28, v1::NUMERIC_TYPE_UINT8);
  EXPECT_THAT(ValidateLayout(overlapping, 7), IsOk());
}

TEST(PointLayoutTest, RefusesStridesAndFieldsOutOfRange) {
  EXPECT_EQ(BlamedAfter([](auto& layout) { layout.set_point_stride(0); }), "point_stride");
  EXPECT_EQ(BlamedAfter([](auto& layout) { layout.set_point_stride(1025); }), "point_stride");
  EXPECT_EQ(BlamedAfter([](auto& layout) { layout.set_point_stride(29); }), "fields[5].offset");
  EXPECT_EQ(BlamedAfter([](auto& layout) { layout.mutable_fields(3)->set_count(5); }), "fields[3].offset");
  EXPECT_EQ(BlamedAfter([](auto& layout) { layout.mutable_fields(3)->set_count(0xFFFFFFFF); }), "fields[3].offset");
  EXPECT_EQ(BlamedAfter([](auto& layout) { layout.mutable_fields(3)->set_offset(0xFFFFFFFF); }), "fields[3].offset");
  const auto fill = [](int size) {
    return [size](v1::PointLayout& layout) {
      for (int i = layout.fields_size(); i < size; ++i) {
        AddField(layout, absl::StrCat("f", i), 12, v1::NUMERIC_TYPE_INT8);
      }
    };
  };
  EXPECT_EQ(BlamedAfter(fill(64)), "");
  EXPECT_EQ(BlamedAfter(fill(65)), "fields");
}

TEST(PointLayoutTest, RefusesNamesAndTypes) {
  const auto rename = [](const std::string& name) {
    return [name](v1::PointLayout& layout) { layout.mutable_fields(3)->set_name(name); };
  };
  EXPECT_EQ(BlamedAfter(rename("")), "fields[3].name");
  EXPECT_EQ(BlamedAfter(rename("t")), "fields[4].name") << "the second of the name";
  EXPECT_EQ(BlamedAfter(rename("a\nb")), "fields[3].name");
  EXPECT_EQ(BlamedAfter(rename(std::string(64, 'n'))), "");
  EXPECT_EQ(BlamedAfter(rename(std::string(65, 'n'))), "fields[3].name");
  const auto retype = [](int type) {
    return [type](v1::PointLayout& layout) { layout.mutable_fields(5)->set_type(static_cast<v1::NumericType>(type)); };
  };
  EXPECT_EQ(BlamedAfter(retype(0)), "fields[5].type");
  EXPECT_EQ(BlamedAfter(retype(9)), "fields[5].type");
  EXPECT_EQ(BlamedAfter(retype(-1)), "fields[5].type");
}

TEST(PointLayoutTest, AsksForPositionsOfOneFloatingType) {
  EXPECT_EQ(BlamedAfter([](auto& layout) { layout.mutable_fields(2)->set_name("Z"); }), "fields");
  EXPECT_EQ(BlamedAfter([](auto& layout) { layout.mutable_fields(1)->set_type(v1::NUMERIC_TYPE_INT32); }), "fields");
  EXPECT_EQ(BlamedAfter([](auto& layout) { layout.mutable_fields(0)->set_count(2); }), "fields");
  EXPECT_EQ(BlamedAfter([](auto& layout) { layout.mutable_fields(2)->set_offset(6); }), "fields") << "overlaps y";
  EXPECT_EQ(BlamedAfter([](auto& layout) { layout.mutable_fields(5)->set_offset(10); }), "fields") << "overlaps z";
  EXPECT_EQ(BlamedAfter([](auto& layout) {
              layout.mutable_fields(0)->set_type(v1::NUMERIC_TYPE_FLOAT64);
              layout.mutable_fields(0)->set_offset(12);
              layout.mutable_fields(3)->set_offset(0);
            }),
            "fields")
      << "x is a double, y is not";
  EXPECT_EQ(Blamed(v1::PointLayout()), "point_stride");
}

TEST(PointLayoutTest, RowsMustHoldAllPoints) {
  v1::PointLayout layout = PackedFloatLayout();
  layout.set_row_padding(4);
  EXPECT_EQ(Blamed(layout), "row_padding");
  layout.set_width(25);
  EXPECT_EQ(Blamed(layout), "");
  EXPECT_EQ(LayoutBytes(layout, 100), 4U * (25 * 12 + 4));
  EXPECT_FALSE(IsPackedFloats(layout));
  layout.set_width(24);
  EXPECT_EQ(Blamed(layout), "width");
  EXPECT_EQ(Blamed(layout, 0), "");
}

TEST(PointLayoutTest, SizesThatDoNotFit64BitsAreTheGreatest) {
  constexpr uint64_t kMax = std::numeric_limits<uint64_t>::max();
  v1::PointLayout layout = PackedFloatLayout();
  EXPECT_EQ(LayoutBytes(layout, 100), 1200U);
  EXPECT_EQ(LayoutBytes(layout, kMax / 12), kMax / 12 * 12);
  EXPECT_EQ(LayoutBytes(layout, kMax / 12 + 1), kMax);
  layout.set_width(1);
  layout.set_row_padding(0xFFFFFFFF);
  EXPECT_EQ(LayoutBytes(layout, uint64_t{1} << 40), kMax);
}

TEST(PointLayoutTest, FindsThePositions) {
  v1::PointLayout layout;
  AddField(layout, "z", 4, v1::NUMERIC_TYPE_FLOAT64);
  AddField(layout, "x", 12, v1::NUMERIC_TYPE_FLOAT64);
  AddField(layout, "y", 20, v1::NUMERIC_TYPE_FLOAT64);
  layout.set_point_stride(28);
  ASSERT_EQ(Blamed(layout), "");
  EXPECT_THAT(PositionsOf(layout).offsets, ::testing::ElementsAre(12, 20, 4));
  EXPECT_TRUE(PositionsOf(layout).is_double);
}

}  // namespace
}  // namespace curvereg::wire
