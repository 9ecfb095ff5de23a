// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/curvelet/curvelet_wedges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/curvelet/curvelet_windows.h"

namespace curvereg {
namespace {

constexpr CurveletOptions kCurveletsAllTheWay{.num_scales = 4, .finest = FinestScale::kCurvelets};

// Calls visit(k1, k2, window) over a wedge's support.
template <typename Visit>
void ForEachFrequency(const CurveletWedge& wedge, const Visit& visit) {
  for (const CurveletWedge::Run& run : wedge.runs) {
    for (int i = 0; i < run.size; ++i) {
      visit(run.k1, run.k2 + i, wedge.weights[run.first_weight + static_cast<size_t>(i)]);
    }
  }
}

TEST(CurveletWedgesTest, AngleCountsDoubleWithEverySecondScale) {
  const CurveletOptions curvelets{.num_scales = 7, .finest = FinestScale::kCurvelets};
  const int expected[] = {1, 16, 32, 32, 64, 64, 128};
  for (int scale = 1; scale <= 7; ++scale) EXPECT_EQ(NumAngles(scale, curvelets), expected[scale - 1]);
  const CurveletOptions wavelets{.num_scales = 4, .num_angles_coarse = 8};
  EXPECT_EQ(NumAngles(3, wavelets), 16);
  EXPECT_EQ(NumAngles(4, wavelets), 1);
}

TEST(CurveletWedgesTest, DefaultNumberOfScales) {
  EXPECT_EQ(DefaultNumScales(720, 361), 6);
  EXPECT_EQ(DefaultNumScales(256, 256), 5);
  EXPECT_EQ(DefaultNumScales(257, 1000), 6);
  EXPECT_EQ(DefaultNumScales(12, 12), 2);
  for (int n = 12; n < 2000; ++n) EXPECT_TRUE(ValidateScales(n, n, DefaultNumScales(n, n)).ok()) << n;
}

// The squared windows of all wedges, both quadrants and their opposites, are the squared scale window: a tight frame.
TEST(CurveletWedgesTest, SquaredWindowsOfAScaleAddUpToItsCorona) {
  for (const auto& [rows, cols] : {std::pair{97, 131}, {90, 120}}) {
    const int scale = 3;
    const LowPass outer1 = MakeLowPass(rows, 1);
    const LowPass outer2 = MakeLowPass(cols, 1);
    const LowPass inner1 = MakeLowPass(rows, 2);
    const LowPass inner2 = MakeLowPass(cols, 2);
    const int side = 2 * 131 + 1;
    std::vector<double> sum(static_cast<size_t>(side * side), 0.0);
    const auto at = [&](int k1, int k2) -> double& { return sum[static_cast<size_t>((k1 + 131) * side + k2 + 131)]; };
    for (const CurveletWedge& wedge : MakeWedges(rows, cols, scale, kCurveletsAllTheWay)) {
      ForEachFrequency(wedge, [&](int k1, int k2, double window) {
        at(k1, k2) += window * window;
        at(-k1, -k2) += window * window;
      });
    }
    for (int k1 = -rows / 2; k1 <= rows / 2; ++k1) {
      for (int k2 = -cols / 2; k2 <= cols / 2; ++k2) {
        const int a1 = std::abs(k1);
        const int a2 = std::abs(k2);
        const double expected =
            std::pow(outer1.Pass(a1) * outer2.Pass(a2), 2) - std::pow(inner1.Pass(a1) * inner2.Pass(a2), 2);
        EXPECT_NEAR(at(k1, k2), expected, 1e-14) << k1 << " " << k2;
      }
    }
  }
}

TEST(CurveletWedgesTest, NoTwoFrequenciesWrapToOnePlace) {
  for (const auto& [rows, cols] : {std::pair{97, 131}, {96, 96}, {64, 150}}) {
    for (int scale = 2; scale <= 4; ++scale) {
      for (const CurveletWedge& wedge : MakeWedges(rows, cols, scale, kCurveletsAllTheWay)) {
        std::set<std::pair<int, int>> taken;
        ForEachFrequency(wedge, [&](int k1, int k2, double window) {
          if (window == 0.0) return;
          const std::pair place(((k1 % wedge.rows) + wedge.rows) % wedge.rows,
                                ((k2 % wedge.cols) + wedge.cols) % wedge.cols);
          EXPECT_TRUE(taken.insert(place).second) << "scale " << scale << " wedge " << wedge.angle;
        });
        EXPECT_FALSE(taken.empty());
      }
    }
  }
}

TEST(CurveletWedgesTest, WedgesRunClockwiseFromTheTopLeftCorner) {
  const std::vector<CurveletWedge> wedges = MakeWedges(128, 128, 3, kCurveletsAllTheWay);
  ASSERT_EQ(wedges.size(), 16U);
  double previous = -3.0 * std::atan(1.0);  // the corner, clockwise from north: -45 degrees = atan2(-1, 1)
  for (size_t i = 0; i < wedges.size(); ++i) {
    EXPECT_EQ(wedges[i].angle, static_cast<int>(i) + 1);
    const double clockwise_from_north = std::atan2(wedges[i].centre_k2, -wedges[i].centre_k1);
    EXPECT_GT(clockwise_from_north, previous);
    previous = clockwise_from_north;
    // The window peaks on the centre's ray.
    ForEachFrequency(wedges[i], [&](int k1, int k2, double) {
      const double cosine = (k1 * wedges[i].centre_k1 + k2 * wedges[i].centre_k2) /
                            (std::hypot(k1, k2) * std::hypot(wedges[i].centre_k1, wedges[i].centre_k2));
      EXPECT_GT(cosine, 0.9);
    });
  }
}

TEST(CurveletWedgesTest, RefusesAnglesThatBreakTheFrame) {
  EXPECT_EQ(ValidateCurveletOptions(128, 128, {.num_angles_coarse = 12}).message(),
            "12 angles at scale 2; must be 8, 16, 32 or 64");
  for (const int bad : {-8, 0, 4, 7, 24, 40, 128}) {
    EXPECT_FALSE(ValidateCurveletOptions(128, 128, {.num_angles_coarse = bad}).ok()) << bad;
  }
  for (const int good : {8, 16, 32, 64}) {
    EXPECT_TRUE(ValidateCurveletOptions(256, 256, {.num_scales = 4, .num_angles_coarse = good}).ok()) << good;
  }
  EXPECT_EQ(ValidateCurveletOptions(49, 49, {.num_scales = 4, .num_angles_coarse = 64}).message(),
            "64 angles at scale 2 are too many for an image of 49 x 49 with 4 scales");
  EXPECT_FALSE(ValidateCurveletOptions(0, 0, {}).ok());
  EXPECT_FALSE(ValidateCurveletOptions(128, 128, {.num_scales = 7}).ok());
  EXPECT_FALSE(ValidateCurveletOptions(128, 128, {.num_scales = 1}).ok());
}

}  // namespace
}  // namespace curvereg
