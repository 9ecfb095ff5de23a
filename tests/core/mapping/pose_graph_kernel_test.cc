// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/pose_graph_kernel.h"

#include <gtest/gtest.h>

#include "core/mapping/pose_graph.h"

namespace curvereg {
namespace {

TEST(Kernel, IsTheSquareNearAndLevelsOffFarOut) {
  EXPECT_EQ(KernelCost(0.0, 25.0), 0.0);
  EXPECT_EQ(KernelWeight(0.0, 25.0), 1.0);
  EXPECT_NEAR(KernelCost(0.01, 25.0), 0.01, 1e-5);
  EXPECT_DOUBLE_EQ(KernelCost(25.0, 25.0), 12.5);
  EXPECT_DOUBLE_EQ(KernelWeight(25.0, 25.0), 0.25);
  EXPECT_NEAR(KernelCost(1e12, 25.0), 25.0, 1e-6);
  EXPECT_LT(KernelWeight(1e12, 25.0), 1e-20);
}

TEST(Kernel, TheWeightIsTheCostsDerivative) {
  for (const double square : {0.1, 4.0, 30.0, 400.0}) {
    constexpr double kStep = 1e-4;
    const double slope = (KernelCost(square + kStep, 25.0) - KernelCost(square - kStep, 25.0)) / (2.0 * kStep);
    EXPECT_NEAR(KernelWeight(square, 25.0), slope, 1e-8) << square;
  }
}

// At the default scale of five.
TEST(Kernel, GivesUpBeyondNineDeviations) {
  EXPECT_GT(KernelWeight(9.0 * 9.0, 25.0), kGivenUpWeight);
  EXPECT_LT(KernelWeight(9.5 * 9.5, 25.0), kGivenUpWeight);
}

}  // namespace
}  // namespace curvereg
