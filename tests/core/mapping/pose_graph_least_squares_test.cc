// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/pose_graph_least_squares.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numeric>
#include <stop_token>
#include <vector>

#include "tests/testing/matchers.h"
#include "tests/testing/pose_graphs.h"

namespace curvereg {
namespace {

using testing::DiagonalCovariance;
using testing::Drive;
using testing::HasCode;
using testing::IsNear;
using testing::IsOk;
using testing::KnownGraph;

// Two edges between two nodes that tell x = 1 m and x = 3 m, the second with twice the deviation.
KnownGraph TwoOpinions() {
  KnownGraph known;
  known.T_graph_node.assign(2, RigidTransform::Identity());
  known.graph.T_graph_node = known.T_graph_node;
  known.AddEdge(1, 0, DiagonalCovariance(0.01, 0.1), Vector6d::Unit(3));
  known.AddEdge(1, 0, DiagonalCovariance(0.01, 0.2), 3.0 * Vector6d::Unit(3));
  return known;
}

double X(const PoseGraphLeastSquares& problem) { return problem.poses()[1].translation().x(); }

TEST(PoseGraphLeastSquares, WeighsByCovarianceAndWeight) {
  const KnownGraph known = TwoOpinions();
  PoseGraphLeastSquares problem(known.graph, {});
  ASSERT_THAT(problem.Improve({1.0, 1.0}), IsOk());
  EXPECT_NEAR(X(problem), (100.0 * 1.0 + 25.0 * 3.0) / 125.0, 1e-6);
  ASSERT_THAT(problem.Improve({0.25, 1.0}), IsOk());
  EXPECT_NEAR(X(problem), 2.0, 1e-6);
  ASSERT_THAT(problem.Improve({1.0, 0.0}), IsOk());
  EXPECT_NEAR(X(problem), 1.0, 1e-6);
}

TEST(PoseGraphLeastSquares, TellsErrorsInStandardDeviations) {
  const KnownGraph known = TwoOpinions();
  PoseGraphLeastSquares problem(known.graph, {});
  EXPECT_THAT(problem.SquaredErrors(),
              ::testing::ElementsAre(::testing::DoubleNear(100.0, 1e-6), ::testing::DoubleNear(225.0, 1e-6)));
  std::vector<RigidTransform> T_graph_node = problem.poses();
  T_graph_node[1].translation().x() = 1.0;
  problem.SetPoses(T_graph_node);
  EXPECT_THAT(problem.SquaredErrors(),
              ::testing::ElementsAre(::testing::DoubleNear(0.0, 1e-6), ::testing::DoubleNear(100.0, 1e-6)));
}

TEST(PoseGraphLeastSquares, AddsUpInformation) {
  const KnownGraph known = TwoOpinions();
  const PoseGraphLeastSquares problem(known.graph, {});
  const auto covariances = problem.Covariances({1.0, 1.0});
  ASSERT_THAT(covariances, IsOk());
  EXPECT_EQ((*covariances)[0], Matrix6d::Zero());
  EXPECT_NEAR((*covariances)[1](3, 3), 1.0 / 125.0, 1e-9);
  EXPECT_NEAR((*covariances)[1](0, 0), 0.5e-4, 1e-9);
  EXPECT_THAT(problem.Covariances({0.0, 0.0}), HasCode(absl::StatusCode::kFailedPrecondition));
}

TEST(PoseGraphLeastSquares, GetsBetterStepByStepFromFarAway) {
  const KnownGraph drive = Drive(40, 3);
  PoseGraphLeastSquares problem(drive.graph, {});
  std::vector<RigidTransform> far = drive.T_graph_node;
  for (size_t i = 1; i < far.size(); ++i) {
    const double s = static_cast<double>(i);
    far[i] = far[i] *
             TransformFromVector((Vector6d() << std::sin(s), 0.0, std::cos(s), 5.0, std::sin(3.0 * s), 1.0).finished());
  }
  problem.SetPoses(far);
  const std::vector<double> weights(drive.graph.edges.size(), 1.0);
  const auto sum = [&] {
    const std::vector<double> errors = problem.SquaredErrors();
    return std::accumulate(errors.begin(), errors.end(), 0.0);
  };
  double before = sum();
  for (int i = 0; i < 40; ++i) {
    ASSERT_THAT(problem.Improve(weights), IsOk());
    const double after = sum();
    EXPECT_LE(after, before * (1.0 + 1e-9));
    before = after;
  }
  EXPECT_LT(before, 2.0 * 6.0 * static_cast<double>(weights.size()));
  for (size_t i = 0; i < far.size(); ++i) EXPECT_THAT(problem.poses()[i], IsNear(drive.T_graph_node[i], 0.2, 0.02));
}

TEST(PoseGraphLeastSquares, Stops) {
  const KnownGraph known = TwoOpinions();
  std::stop_source source;
  source.request_stop();
  PoseGraphLeastSquares cancelled(known.graph, {}, {.cancellation = source.get_token(), .deadline = {}});
  EXPECT_THAT(cancelled.Improve({1.0, 1.0}), HasCode(absl::StatusCode::kCancelled));
  EXPECT_EQ(X(cancelled), 0.0);
  PoseGraphLeastSquares late(known.graph, {}, {.cancellation = {}, .deadline = std::chrono::steady_clock::now()});
  EXPECT_THAT(late.Improve({1.0, 1.0}), HasCode(absl::StatusCode::kDeadlineExceeded));
  EXPECT_EQ(X(late), 0.0);
}

}  // namespace
}  // namespace curvereg
