// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/traverse.h"

#include <gtest/gtest.h>

#include <cmath>

namespace curvereg::sim {
namespace {

double MeanStep(const std::vector<Waypoint>& stops) {
  double sum = 0.0;
  for (std::size_t i = 1; i < stops.size(); ++i) sum += (stops[i].place - stops[i - 1].place).norm();
  return sum / static_cast<double>(stops.size() - 1);
}

TEST(TraverseTest, ZigzagStaysInsideAtItsStep) {
  const HeightGrid grid = MakeHeightGrid(120.0, 60.0, 1.0);
  for (const int num_scans : {2, 17, 40, 90}) {
    const TraverseOptions options;
    const absl::StatusOr<std::vector<Waypoint>> stops = PlanTraverse(grid, options, num_scans, 3);
    ASSERT_TRUE(stops.ok());
    ASSERT_EQ(stops->size(), static_cast<std::size_t>(num_scans));
    for (const Waypoint& stop : *stops) {
      EXPECT_LE(std::abs(stop.place.x()), 60.0 - options.margin_m + 1e-9);
      EXPECT_LE(std::abs(stop.place.y()), 30.0 - options.margin_m + 1e-9);
      EXPECT_LT(std::abs(stop.heading_rad), 0.5) << "it never turns round";
    }
    EXPECT_NEAR(MeanStep(*stops), options.step_m, 0.1 * options.step_m);
  }
}

TEST(TraverseTest, HeadingIsTheDirectionOfMotion) {
  const HeightGrid grid = MakeHeightGrid(400.0, 400.0, 1.0);
  for (const TraverseShape shape : {TraverseShape::kZigzag, TraverseShape::kLoop}) {
    const TraverseOptions options = {.shape = shape, .step_m = 0.05, .step_variation = 0.0, .loop_radius_m = 20.0};
    const absl::StatusOr<std::vector<Waypoint>> stops = PlanTraverse(grid, options, 500, 3);
    ASSERT_TRUE(stops.ok());
    for (std::size_t i = 1; i < stops->size(); ++i) {
      const Eigen::Vector2d motion = ((*stops)[i].place - (*stops)[i - 1].place).normalized();
      const Eigen::Vector2d heading(std::cos((*stops)[i].heading_rad), std::sin((*stops)[i].heading_rad));
      EXPECT_GT(motion.dot(heading), 0.9995);
    }
  }
}

TEST(TraverseTest, LoopDrivesItsStep) {
  const HeightGrid grid = MakeHeightGrid(40.0, 40.0, 1.0);
  const TraverseOptions options = {.shape = TraverseShape::kLoop, .step_m = 0.5, .step_variation = 0.0};
  const absl::StatusOr<std::vector<Waypoint>> stops = PlanTraverse(grid, options, 200, 3);
  ASSERT_TRUE(stops.ok());
  EXPECT_NEAR(MeanStep(*stops), 0.5, 0.003);
  for (const Waypoint& stop : *stops) EXPECT_NEAR(stop.place.norm(), options.loop_radius_m, 0.07 * 5.3);
}

TEST(TraverseTest, TooSmallGroundIsRefused) {
  EXPECT_EQ(PlanTraverse(MakeHeightGrid(12.0, 60.0, 1.0), {}, 5, 1).status().code(),
            absl::StatusCode::kInvalidArgument);
  const TraverseOptions loop = {.shape = TraverseShape::kLoop, .loop_radius_m = 30.0};
  const absl::Status status = PlanTraverse(MakeHeightGrid(60.0, 60.0, 1.0), loop, 5, 1).status();
  EXPECT_EQ(status.message(), "the ground leaves 46.0 m x 46.0 m to drive on; the traverse needs 66.0 m");
}

}  // namespace
}  // namespace curvereg::sim
