// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/curvelet/curvelet_windows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace curvereg {
namespace {

TEST(CurveletWindowsTest, StepFallsSmoothlyFromOneToZero) {
  EXPECT_EQ(FallingStep(-3.0), 1.0);
  EXPECT_EQ(FallingStep(0.0), 1.0);
  EXPECT_EQ(FallingStep(1.0), 0.0);
  EXPECT_EQ(FallingStep(7.0), 0.0);
  EXPECT_DOUBLE_EQ(FallingStep(0.5), std::sqrt(0.5));
  double previous = 1.0;
  for (int i = 0; i <= 1000; ++i) {
    const double x = i / 1000.0;
    EXPECT_LE(FallingStep(x), previous) << x;
    EXPECT_NEAR(std::pow(FallingStep(x), 2) + std::pow(RisingStep(x), 2), 1.0, 1e-15) << x;
    EXPECT_NEAR(RisingStep(x), FallingStep(1.0 - x), 1e-12) << x;
    previous = FallingStep(x);
  }
}

TEST(CurveletWindowsTest, StepIsFiniteAtItsEnds) {
  for (const double x : {1e-300, 1e-17, 1e-9, 1e-3, 1.0 - 1e-3, 1.0 - 1e-9, std::nextafter(1.0, 0.0)}) {
    EXPECT_NEAR(FallingStep(x), x < 0.5 ? 1.0 : 0.0, 1e-12) << x;
    EXPECT_NEAR(RisingStep(x), x < 0.5 ? 0.0 : 1.0, 1e-12) << x;
  }
}

TEST(CurveletWindowsTest, LowPassOfLevelZeroComplementsItsAlias) {
  for (int n = 12; n < 200; ++n) {
    const LowPass low_pass = MakeLowPass(n, 0);
    for (int k = 0; k <= n; ++k) {
      EXPECT_NEAR(std::pow(low_pass.Pass(k), 2) + std::pow(low_pass.Pass(n - k), 2), 1.0, 1e-14) << n << " " << k;
    }
  }
}

TEST(CurveletWindowsTest, LowPassIsFlatThenFalls) {
  const LowPass low_pass = MakeLowPass(96, 1);  // transition between 16 and 32
  EXPECT_EQ(low_pass.support(), 32);
  EXPECT_EQ(low_pass.Pass(17), 1.0);
  EXPECT_LT(low_pass.Pass(18), 1.0);
  EXPECT_GT(low_pass.Pass(31), 0.0);
  EXPECT_EQ(low_pass.Pass(32), 0.0);
  EXPECT_EQ(low_pass.Pass(90), 0.0);
  for (int k = 0; k < 40; ++k) {
    EXPECT_NEAR(std::pow(low_pass.Pass(k), 2) + std::pow(low_pass.Stop(k), 2), 1.0, 1e-15) << k;
  }
}

TEST(CurveletWindowsTest, EachLevelIsOneWhereTheNextIsNotZero) {
  for (const int n : {96, 97, 131, 180, 361}) {
    for (int level = 0; level < 3; ++level) {
      const LowPass wide = MakeLowPass(n, level);
      const LowPass narrow = MakeLowPass(n, level + 1);
      for (int k = 0; k <= n; ++k) {
        if (narrow.Pass(k) > 0.0) {
          EXPECT_EQ(wide.Pass(k), 1.0) << n << " " << level << " " << k;
        }
      }
    }
  }
}

TEST(CurveletWindowsTest, RefusesTooManyScales) {
  EXPECT_TRUE(ValidateScales(192, 200, 6).ok());
  EXPECT_EQ(ValidateScales(191, 200, 6).message(), "6 scales are too many for an image of 191 x 200; at most 5");
  EXPECT_EQ(ValidateScales(191, 200, 1).message(), "1 scales; at least 2 are needed");
  EXPECT_EQ(ValidateScales(0, 200, 2).message(), "image is empty: 0 x 200");
  EXPECT_FALSE(ValidateScales(11, 200, 2).ok());
  EXPECT_FALSE(ValidateScales(512, 512, std::numeric_limits<int>::max()).ok());
  EXPECT_FALSE(ValidateScales(512, 512, std::numeric_limits<int>::min()).ok());
}

}  // namespace
}  // namespace curvereg
