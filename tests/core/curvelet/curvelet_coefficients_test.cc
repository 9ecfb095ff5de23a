// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/curvelet/curvelet_coefficients.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace curvereg {
namespace {

using Complex = std::complex<double>;
using ::testing::ElementsAre;

template <typename Value>
CurveletCoefficients<Value> TwoScales(const std::vector<Value>& values) {
  Image<Value> array(1, static_cast<int>(values.size()));
  array.pixels = values;
  return {.scales = {{array}, {array, array}}};
}

TEST(CurveletCoefficientsTest, HardThresholdKeepsWhatIsLarger) {
  auto curvelets = TwoScales<double>({-3.0, 1.0, 0.5, -1.5, 0.0});
  HardThreshold(1.0, curvelets);
  EXPECT_THAT(curvelets.scales[0][0].pixels, ElementsAre(-3.0, 1.0, 0.5, -1.5, 0.0)) << "scale 1 is left alone";
  EXPECT_THAT(curvelets.scales[1][0].pixels, ElementsAre(-3.0, 0.0, 0.0, -1.5, 0.0));
  EXPECT_EQ(curvelets.scales[1][1].pixels, curvelets.scales[1][0].pixels);
}

TEST(CurveletCoefficientsTest, SoftThresholdDrawsTowardsZero) {
  auto curvelets = TwoScales<double>({-3.0, 1.0, 0.5, -1.5, 0.0});
  SoftThreshold(1.0, curvelets);
  EXPECT_THAT(curvelets.scales[0][0].pixels, ElementsAre(-3.0, 1.0, 0.5, -1.5, 0.0));
  EXPECT_THAT(curvelets.scales[1][1].pixels, ElementsAre(-2.0, 0.0, 0.0, -0.5, 0.0));
}

TEST(CurveletCoefficientsTest, ComplexCoefficientsAreJudgedByTheirModulus) {
  auto hard = TwoScales<Complex>({{0.6, 0.8}, {3.0, -4.0}});
  auto soft = hard;
  HardThreshold(2.5, hard);
  EXPECT_THAT(hard.scales[1][0].pixels, ElementsAre(Complex(0.0), Complex(3.0, -4.0)));
  SoftThreshold(2.5, soft);
  EXPECT_THAT(soft.scales[1][0].pixels, ElementsAre(Complex(0.0), Complex(1.5, -2.0)));
}

TEST(CurveletCoefficientsTest, ZeroThresholdChangesNothing) {
  const auto curvelets = TwoScales<double>({-3.0, 0.0, 1e-300});
  for (auto* threshold : {static_cast<void (*)(double, RealCurvelets&)>(HardThreshold),
                          static_cast<void (*)(double, RealCurvelets&)>(SoftThreshold)}) {
    auto same = curvelets;
    threshold(0.0, same);
    EXPECT_EQ(same.scales[1][0].pixels, curvelets.scales[1][0].pixels);
  }
  RealCurvelets empty;
  SoftThreshold(1.0, empty);
  EXPECT_TRUE(empty.scales.empty());
}

}  // namespace
}  // namespace curvereg
