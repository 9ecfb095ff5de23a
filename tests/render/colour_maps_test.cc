// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "render/colour_maps.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Core>

namespace curvereg {
namespace {

Eigen::Vector3d LinearOf(const Rgb& colour) {
  const auto linear = [](uint8_t byte) {
    const double u = byte / 255.0;
    return u <= 0.04045 ? u / 12.92 : std::pow((u + 0.055) / 1.055, 2.4);
  };
  return {linear(colour[0]), linear(colour[1]), linear(colour[2])};
}

// CIE L*a*b* of linear sRGB, white point D65.
Eigen::Vector3d LabOf(const Eigen::Vector3d& linear) {
  const Eigen::Matrix3d xyz_of_rgb =
      (Eigen::Matrix3d() << 0.4124, 0.3576, 0.1805, 0.2126, 0.7152, 0.0722, 0.0193, 0.1192, 0.9505).finished();
  const Eigen::Vector3d xyz = (xyz_of_rgb * linear).cwiseQuotient(Eigen::Vector3d(0.9505, 1.0, 1.089));
  const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116.0; };
  return {116.0 * f(xyz.y()) - 16.0, 500.0 * (f(xyz.x()) - f(xyz.y())), 200.0 * (f(xyz.y()) - f(xyz.z()))};
}

double Lightness(const Rgb& colour) { return LabOf(LinearOf(colour))[0]; }

// As an eye without the green cones sees it [G. M. Machado, M. M. Oliveira, L. A. F. Fernandes, "A
// Physiologically-based Model for Simulation of Color Vision Deficiency", 2009, table 1, severity 1.0].
Eigen::Vector3d SeenByDeuteranope(const Eigen::Vector3d& linear) {
  const Eigen::Matrix3d seen =
      (Eigen::Matrix3d() << 0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940, 0.968881)
          .finished();
  return (seen * linear).cwiseMax(0.0).cwiseMin(1.0);
}

// Distance of both in L*a*b*, as such an eye sees them; 2.3 is just noticeable.
double DistanceForDeuteranope(const Rgb& a, const Rgb& b) {
  return (LabOf(SeenByDeuteranope(LinearOf(a))) - LabOf(SeenByDeuteranope(LinearOf(b)))).norm();
}

TEST(HeightColour, LightnessRisesEvenly) {
  double previous = Lightness(HeightColour(0.0));
  EXPECT_LT(previous, 15.0);
  for (int i = 1; i <= 10; ++i) {
    const double lightness = Lightness(HeightColour(i / 10.0));
    EXPECT_NEAR(lightness - previous, 8.0, 3.0) << i;
    previous = lightness;
  }
  EXPECT_GT(previous, 85.0);
  EXPECT_EQ(HeightColour(-1.0), HeightColour(0.0));
  EXPECT_EQ(HeightColour(2.0), HeightColour(1.0));
  EXPECT_EQ(HeightColour(std::nan("")), HeightColour(0.0));
}

TEST(HeightColour, EndsAreThoseOfViridis) {
  EXPECT_EQ(HeightColour(0.0), (Rgb{68, 1, 84}));
  EXPECT_EQ(HeightColour(1.0), (Rgb{253, 231, 37}));
}

TEST(SignedColour, WhiteAtZeroAndDifferentEnds) {
  EXPECT_EQ(SignedColour(0.0), (Rgb{255, 255, 255}));
  EXPECT_EQ(SignedColour(std::nan("")), (Rgb{255, 255, 255}));
  EXPECT_GT(SignedColour(-1.0)[2], SignedColour(-1.0)[0]);
  EXPECT_GT(SignedColour(1.0)[0], SignedColour(1.0)[2]);
  EXPECT_EQ(SignedColour(-9.0), SignedColour(-1.0));
}

TEST(SignedColour, BothSidesAreAboutAsLight) {
  for (const double value : {0.25, 0.5, 0.75, 1.0}) {
    EXPECT_NEAR(Lightness(SignedColour(value)), Lightness(SignedColour(-value)), 8.0) << value;
    EXPECT_LT(Lightness(SignedColour(value)), Lightness(SignedColour(value - 0.25))) << value;
  }
}

TEST(GreyColour, RisesFromBlackToWhite) {
  EXPECT_EQ(GreyColour(0.0), (Rgb{0, 0, 0}));
  EXPECT_EQ(GreyColour(1.0), (Rgb{255, 255, 255}));
  EXPECT_EQ(GreyColour(std::nan("")), GreyColour(0.0));
  EXPECT_GT(Lightness(BackgroundColour(1.0)), Lightness(BackgroundColour(0.0)) + 40.0);
}

TEST(ColourVision, MapsKeepTheirStepsWithoutGreenCones) {
  for (int i = 0; i < 8; ++i) {
    EXPECT_GT(DistanceForDeuteranope(HeightColour(i / 8.0), HeightColour((i + 1) / 8.0)), 5.0) << i;
    EXPECT_GT(DistanceForDeuteranope(SignedColour(i / 4.0 - 1.0), SignedColour((i + 1) / 4.0 - 1.0)), 5.0) << i;
  }
  // Far values are farther apart than near ones.
  for (int i = 2; i <= 8; ++i) {
    EXPECT_GT(DistanceForDeuteranope(HeightColour(0.0), HeightColour(i / 8.0)),
              DistanceForDeuteranope(HeightColour(0.0), HeightColour((i - 1) / 8.0)))
        << i;
  }
}

TEST(ColourVision, SignsDifferWithoutGreenCones) {
  EXPECT_GT(DistanceForDeuteranope(SignedColour(-1.0), SignedColour(1.0)), 40.0);
  EXPECT_GT(DistanceForDeuteranope(SignedColour(-0.5), SignedColour(0.5)), 25.0);
  EXPECT_GT(DistanceForDeuteranope(kVermilion, kBlue), 40.0);
  // The measure finds what such an eye confuses: a red and a green of one lightness.
  EXPECT_LT(DistanceForDeuteranope({200, 80, 60}, {134, 112, 60}), 12.0);
}

}  // namespace
}  // namespace curvereg
