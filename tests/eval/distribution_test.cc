// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/distribution.h"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace curvereg {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(Quantile, InterpolatesBetweenOrderStatistics) {
  const std::vector<double> values = {4.0, 1.0, 3.0, 2.0};
  EXPECT_DOUBLE_EQ(Quantile(values, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(Quantile(values, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(Quantile(values, 0.95), 3.85);
  EXPECT_DOUBLE_EQ(Quantile(values, 1.0), 4.0);
}

TEST(Quantile, ClampsTheShareAndLeavesOutWhatIsNotFinite) {
  const std::vector<double> values = {kNan, 7.0, INFINITY, 5.0};
  EXPECT_DOUBLE_EQ(Quantile(values, -1.0), 5.0);
  EXPECT_DOUBLE_EQ(Quantile(values, 2.0), 7.0);
}

TEST(Quantile, OfNothingIsNan) {
  EXPECT_TRUE(std::isnan(Quantile({}, 0.5)));
  EXPECT_TRUE(std::isnan(Quantile(std::vector<double>{kNan}, 0.5)));
}

TEST(RootMeanSquare, KnownValues) {
  EXPECT_DOUBLE_EQ(RootMeanSquare(std::vector<double>{3.0, 4.0}), std::sqrt(12.5));
  EXPECT_DOUBLE_EQ(RootMeanSquare(std::vector<double>{-2.0, kNan}), 2.0);
  EXPECT_TRUE(std::isnan(RootMeanSquare({})));
}

TEST(EmpiricalDistribution, OneStepPerDistinctValue) {
  const auto steps = EmpiricalDistribution(std::vector<double>{2.0, 1.0, 2.0, 5.0}, 4);
  ASSERT_EQ(steps.size(), 3u);
  EXPECT_EQ(steps[0].value, 1.0);
  EXPECT_EQ(steps[0].share, 0.25);
  EXPECT_EQ(steps[1].value, 2.0);
  EXPECT_EQ(steps[1].share, 0.75);
  EXPECT_EQ(steps[2].share, 1.0);
}

TEST(EmpiricalDistribution, MissingValuesKeepTheLastShareBelowOne) {
  const auto steps = EmpiricalDistribution(std::vector<double>{1.0, kNan}, 4);
  ASSERT_EQ(steps.size(), 1u);
  EXPECT_EQ(steps[0].share, 0.25);
  EXPECT_TRUE(EmpiricalDistribution({}, 0).empty());
}

TEST(EmpiricalDistribution, RisesStrictlyToOne) {
  std::mt19937 generator(1);
  std::vector<double> values(500);
  for (double& value : values) value = static_cast<double>(generator() % 100);
  const auto steps = EmpiricalDistribution(values, 500);
  for (std::size_t i = 1; i < steps.size(); ++i) {
    EXPECT_LT(steps[i - 1].value, steps[i].value);
    EXPECT_LT(steps[i - 1].share, steps[i].share);
  }
  EXPECT_EQ(steps.back().share, 1.0);
}

}  // namespace
}  // namespace curvereg
