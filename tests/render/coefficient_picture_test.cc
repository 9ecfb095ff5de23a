// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "render/coefficient_picture.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/curvelet/curvelet_transform.h"

namespace curvereg {
namespace {

constexpr int kSize = 128;
constexpr int kPicturePx = 256;

// Mean grey inside the picture's rows [r0, r1) and columns [c0, c1).
double MeanGrey(const Image<uint8_t>& picture, int r0, int r1, int c0, int c1) {
  double sum = 0.0;
  for (int row = r0; row < r1; ++row) {
    for (int col = c0; col < c1; ++col) sum += picture(row, col);
  }
  return sum / ((r1 - r0) * (c1 - c0));
}

// The display of a wave of (k1, k2) cycles per image downwards and to the right, inside a window of Gaussian shape.
Image<uint8_t> DisplayOfWave(double k1, double k2, FinestScale finest = FinestScale::kCurvelets) {
  Image<double> image(kSize, kSize);
  for (int row = 0; row < kSize; ++row) {
    for (int col = 0; col < kSize; ++col) {
      const double window = std::exp(-0.002 * (std::pow(row - 64.0, 2) + std::pow(col - 64.0, 2)));
      image(row, col) = window * std::cos(2.0 * M_PI * (k1 * row + k2 * col) / kSize);
    }
  }
  const auto transform = CurveletTransform::Create(kSize, kSize, {.num_scales = 4, .finest = finest});
  EXPECT_TRUE(transform.ok()) << transform.status();
  const auto curvelets = transform->ForwardComplex(image);
  EXPECT_TRUE(curvelets.ok()) << curvelets.status();
  return CoefficientPicture(*curvelets, kPicturePx);
}

TEST(CoefficientPicture, DirectionOfAWaveIsWhereItsCoefficientsAre) {
  const Image<uint8_t> across = DisplayOfWave(0.0, 52.0);  // varies along columns: left and right
  EXPECT_GT(MeanGrey(across, 96, 160, 200, 256), 60.0);
  EXPECT_GT(MeanGrey(across, 96, 160, 0, 56), 60.0);
  EXPECT_LT(MeanGrey(across, 0, 56, 96, 160), 5.0);
  const Image<uint8_t> down = DisplayOfWave(52.0, 0.0);
  EXPECT_GT(MeanGrey(down, 0, 56, 96, 160), 60.0);
  EXPECT_LT(MeanGrey(down, 96, 160, 200, 256), 5.0);
}

TEST(CoefficientPicture, SlantedWavesGoToTheirCorner) {
  // Frequencies (k1, k2) and (-k1, -k2) are one wave: k1 and k2 of one sign lie lower right and upper left.
  const Image<uint8_t> picture = DisplayOfWave(40.0, 44.0);
  EXPECT_GT(MeanGrey(picture, 200, 256, 200, 256), 60.0);
  EXPECT_GT(MeanGrey(picture, 0, 56, 0, 56), 60.0);
  EXPECT_LT(MeanGrey(picture, 0, 56, 200, 256), 5.0);
}

TEST(CoefficientPicture, CoarserWavesLieFurtherIn) {
  const Image<uint8_t> picture = DisplayOfWave(0.0, 13.0);
  EXPECT_GT(MeanGrey(picture, 112, 144, 160, 192), 60.0);
  EXPECT_LT(MeanGrey(picture, 112, 144, 220, 256), 5.0);
}

TEST(CoefficientPicture, ArraysAreShownTheRightWayUp) {
  // A wave in the upper half of the image: its arrays are brighter in their upper half, on the right and on the left.
  Image<double> image(kSize, kSize);
  for (int row = 0; row < kSize; ++row) {
    for (int col = 0; col < kSize; ++col) {
      image(row, col) = std::exp(-0.01 * std::pow(row - 30.0, 2)) * std::cos(2.0 * M_PI * 52.0 * col / kSize);
    }
  }
  const auto transform = CurveletTransform::Create(kSize, kSize, {.num_scales = 4, .finest = FinestScale::kCurvelets});
  ASSERT_TRUE(transform.ok()) << transform.status();
  const auto curvelets = transform->ForwardComplex(image);
  ASSERT_TRUE(curvelets.ok()) << curvelets.status();
  // 32 wedges at the finest scale, 8 a side: the fifth of the right side spans the outer edge's rows 128 to 160.
  const Image<uint8_t> picture = CoefficientPicture(*curvelets, kPicturePx);
  EXPECT_GT(MeanGrey(picture, 132, 142, 244, 256), MeanGrey(picture, 148, 158, 244, 256) + 20.0);
  EXPECT_GT(MeanGrey(picture, 132, 142, 0, 12), MeanGrey(picture, 148, 158, 0, 12) + 20.0);
}

TEST(CoefficientPicture, WaveletsAndNothingAreNoFault) {
  EXPECT_EQ(DisplayOfWave(0.0, 52.0, FinestScale::kWavelets).rows, kPicturePx);
  EXPECT_EQ(CoefficientPicture(ComplexCurvelets{}, 8).pixels, Image<uint8_t>(8, 8).pixels);
}

}  // namespace
}  // namespace curvereg
