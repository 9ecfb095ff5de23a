// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/rigid_transform.h"

#include <gtest/gtest.h>

#include <numbers>

namespace curvereg {
namespace {

TEST(RigidTransformTest, RotationVectorRoundTripsUpToPi) {
  const Eigen::Vector3d axis = Eigen::Vector3d(0.3, -0.5, 0.81).normalized();
  for (const double angle : {0.0, 1e-15, 1e-9, 1e-4, 0.5, 2.0, 3.1, std::numbers::pi - 1e-7}) {
    const Eigen::Vector3d omega = angle * axis;
    EXPECT_LT((VectorFromRotation(RotationFromVector(omega)) - omega).norm(), 1e-8) << angle;
  }
}

TEST(RigidTransformTest, QuarterTurnAboutZMapsXToY) {
  const Eigen::Matrix3d R = RotationFromVector({0.0, 0.0, std::numbers::pi / 2});
  EXPECT_LT((R * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-15);
}

TEST(RigidTransformTest, DifferenceMeasuresAngleAndDistance) {
  Vector6d delta;
  delta << 0.0, 0.0, 0.25, 3.0, 4.0, 0.0;
  const TransformDifference difference = Difference(RigidTransform::Identity(), TransformFromVector(delta));
  EXPECT_NEAR(difference.rotation_rad, 0.25, 1e-12);
  EXPECT_NEAR(difference.translation_m, 5.0, 1e-12);
}

TEST(RigidTransformTest, IsRigidRefusesScaleMirrorAndNan) {
  RigidTransform T = RigidTransform::Identity();
  EXPECT_TRUE(IsRigid(T));
  T.linear() *= 1.01;
  EXPECT_FALSE(IsRigid(T));
  T.linear() = Eigen::Vector3d(1.0, 1.0, -1.0).asDiagonal();
  EXPECT_FALSE(IsRigid(T));
  T.linear().setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(IsRigid(T));
}

TEST(RigidTransformTest, OrthonormalisedRepairsRounding) {
  RigidTransform T = TransformFromVector((Vector6d() << 0.4, 0.1, -2.0, 1.0, 2.0, 3.0).finished());
  T.linear().array() += 1e-4;
  EXPECT_FALSE(IsRigid(T));
  EXPECT_TRUE(IsRigid(Orthonormalised(T), 1e-12));
}

}  // namespace
}  // namespace curvereg
