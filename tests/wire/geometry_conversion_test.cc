// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/geometry_conversion.h"

#include <cmath>
#include <functional>

#include "tests/testing/matchers.h"
#include "tests/wire/conversion_samples.h"

namespace curvereg::wire {
namespace {

using ::curvereg::testing::IsNear;
using ::curvereg::testing::IsOk;

TEST(GeometryConversionTest, TransformsComeBackAtAnyAttitude) {
  for (int i = 0; i < 200; ++i) {
    RigidTransform T = RigidTransform::Identity();
    T.linear() = RotationFromVector({0.1 * i, 3.1 - 0.07 * i, std::sin(1.0 * i)});
    T.translation() << i, -1e5 * i, 1e-7 * i;
    const v1::RigidTransform message = ToWire(T);
    EXPECT_GE(message.rotation().w(), 0.0);
    const auto back = FromWire(message);
    ASSERT_THAT(back, IsOk());
    EXPECT_THAT(*back, IsNear(T, 0.0, 1e-14));
    EXPECT_EQ(back->translation(), T.translation());
  }
}

TEST(GeometryConversionTest, QuaternionsNearUnitLengthAreNormalised) {
  v1::RigidTransform message = ToWire(SomePose());
  for (auto* rotation = message.mutable_rotation(); const double scale : {0.991, 1.009}) {
    const v1::Quaternion unit = ToWire(SomePose()).rotation();
    rotation->set_x(scale * unit.x());
    rotation->set_y(scale * unit.y());
    rotation->set_z(scale * unit.z());
    rotation->set_w(scale * unit.w());
    const auto back = FromWire(message);
    ASSERT_THAT(back, IsOk());
    EXPECT_THAT(*back, IsNear(SomePose(), 0.0, 1e-12));
  }
}

TEST(GeometryConversionTest, UnusableTransformsNameTheField) {
  const auto field_after = [](const std::function<void(v1::RigidTransform&)>& change) {
    v1::RigidTransform message = ToWire(SomePose());
    change(message);
    return FieldOf(FromWire(message).status());
  };
  EXPECT_EQ(field_after([](auto& T) { T.clear_translation(); }), "translation");
  EXPECT_EQ(field_after([](auto& T) { T.clear_rotation(); }), "rotation");
  EXPECT_EQ(field_after([](auto& T) { T.mutable_translation()->set_y(kNan); }), "translation");
  EXPECT_EQ(field_after([](auto& T) { T.mutable_translation()->set_z(-kInfinity); }), "translation");
  EXPECT_EQ(field_after([](auto& T) { T.mutable_rotation()->set_w(kNan); }), "rotation");
  EXPECT_EQ(field_after([](auto& T) { T.mutable_rotation()->set_x(1.5); }), "rotation");
  EXPECT_EQ(field_after([](auto& T) { *T.mutable_rotation() = v1::Quaternion(); }), "rotation");
}

TEST(GeometryConversionTest, CovariancesComeBackToTheBit) {
  const Matrix6d covariance = SomeCovariance();
  const v1::PoseCovariance message = ToWire(covariance);
  ASSERT_EQ(message.upper_triangle_size(), 21);
  EXPECT_EQ(message.upper_triangle(1), covariance(0, 1));
  EXPECT_EQ(message.upper_triangle(6), covariance(1, 1));
  EXPECT_EQ(message.upper_triangle(20), covariance(5, 5));
  const auto back = FromWire(message);
  ASSERT_THAT(back, IsOk());
  EXPECT_EQ(*back, covariance);
}

TEST(GeometryConversionTest, UnusableCovariancesAreRefused) {
  v1::PoseCovariance too_short = ToWire(SomeCovariance());
  too_short.mutable_upper_triangle()->RemoveLast();
  v1::PoseCovariance too_long = ToWire(SomeCovariance());
  too_long.add_upper_triangle(1.0);
  v1::PoseCovariance not_finite = ToWire(SomeCovariance());
  not_finite.set_upper_triangle(3, kInfinity);
  v1::PoseCovariance negative = ToWire(SomeCovariance());
  negative.set_upper_triangle(0, -1.0);
  const v1::PoseCovariance zero = ToWire(Matrix6d(Matrix6d::Zero()));
  for (const v1::PoseCovariance& message : {v1::PoseCovariance(), too_short, too_long, not_finite, negative, zero}) {
    EXPECT_EQ(FieldOf(FromWire(message).status()), "upper_triangle") << message.ShortDebugString();
  }
}

}  // namespace
}  // namespace curvereg::wire
