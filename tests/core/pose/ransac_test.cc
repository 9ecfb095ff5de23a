// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pose/ransac.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace curvereg {
namespace {

RigidTransform Truth() {
  RigidTransform T = RigidTransform::Identity();
  T.linear() = RotationFromVector({0.05, -0.1, 1.2});
  T.translation() = Eigen::Vector3d(3.0, -1.5, 0.2);
  return T;
}

Eigen::Vector3d RandomPoint(std::mt19937_64& generator) {
  const auto uniform = [&] { return static_cast<double>(generator() >> 11U) * 0x1.0p-53; };
  return {60.0 * uniform() - 30.0, 60.0 * uniform() - 30.0, 4.0 * uniform()};
}

// Of `count` pairs every `right_every`-th agrees with Truth() to 10 cm, the others join anything with anything.
std::vector<PointPair> Pairs(int count, int right_every) {
  std::mt19937_64 generator(7);
  std::vector<PointPair> pairs;
  for (int i = 0; i < count; ++i) {
    PointPair pair{RandomPoint(generator), RandomPoint(generator)};
    if (i % right_every == 0) {
      const double angle = 0.9 * i;
      pair.target = Truth() * pair.source + 0.1 * Eigen::Vector3d(std::sin(angle), std::cos(angle), 0.0);
    }
    pairs.push_back(pair);
  }
  return pairs;
}

TEST(RansacTest, FindsOneRightPairInTen) {
  const std::vector<PointPair> pairs = Pairs(300, 10);
  const auto result = FindRigidConsensus(pairs, {}, Stop{});
  ASSERT_TRUE(result.ok()) << result.status();
  ASSERT_TRUE(result->T_target_source.has_value());
  EXPECT_TRUE(result->is_complete);
  const TransformDifference error = Difference(*result->T_target_source, Truth());
  EXPECT_LT(error.translation_m, 0.5);
  EXPECT_LT(error.rotation_rad, 0.05);
  int num_right = 0;
  for (const int i : result->inliers) num_right += i % 10 == 0 ? 1 : 0;
  EXPECT_GE(num_right, 27);
  for (size_t i = 1; i < result->inliers.size(); ++i) EXPECT_LT(result->inliers[i - 1], result->inliers[i]);
}

TEST(RansacTest, InliersAreExactlyThePairsWithinTheThreshold) {
  const std::vector<PointPair> pairs = Pairs(200, 4);
  const RansacOptions options;
  const RansacResult result = *FindRigidConsensus(pairs, options, Stop{});
  std::vector<int> expected;
  for (size_t i = 0; i < pairs.size(); ++i) {
    const double distance = (*result.T_target_source * pairs[i].source - pairs[i].target).norm();
    if (distance <= options.inlier_threshold_m) expected.push_back(static_cast<int>(i));
  }
  EXPECT_EQ(result.inliers, expected);
}

TEST(RansacTest, EndsEarlyWhenMostPairsAreRight) {
  const RansacResult right = *FindRigidConsensus(Pairs(100, 1), {}, Stop{});
  EXPECT_LE(right.num_iterations, 20);
  EXPECT_EQ(right.inliers.size(), 100U);
  const RansacResult half = *FindRigidConsensus(Pairs(100, 2), {}, Stop{});
  EXPECT_LT(half.num_iterations, 200);
  EXPECT_GE(half.inliers.size(), 48U);
}

TEST(RansacTest, StopsAtTheLimitOfIterationsWhenNothingAgrees) {
  const RansacOptions options{.inlier_threshold_m = 0.01, .max_iterations = 5000};
  const RansacResult result = *FindRigidConsensus(Pairs(300, 1000), options, Stop{});
  EXPECT_EQ(result.num_iterations, 5000);
  EXPECT_TRUE(result.is_complete);
  EXPECT_LT(result.inliers.size(), 5U);
}

TEST(RansacTest, SameSeedSameAnswerOtherSeedOtherSamples) {
  const std::vector<PointPair> pairs = Pairs(300, 10);
  const RansacResult first = *FindRigidConsensus(pairs, {.seed = 5}, Stop{});
  const RansacResult again = *FindRigidConsensus(pairs, {.seed = 5}, Stop{});
  EXPECT_EQ(first.T_target_source->matrix(), again.T_target_source->matrix());
  EXPECT_EQ(first.inliers, again.inliers);
  EXPECT_EQ(first.num_iterations, again.num_iterations);
  const RansacResult other = *FindRigidConsensus(pairs, {.seed = 6}, Stop{});
  EXPECT_NE(first.T_target_source->matrix(), other.T_target_source->matrix());
}

TEST(RansacTest, DegeneratePairsGiveNoPose) {
  EXPECT_FALSE(FindRigidConsensus({}, {}, Stop{})->T_target_source.has_value());
  EXPECT_FALSE(FindRigidConsensus(Pairs(2, 1), {}, Stop{})->T_target_source.has_value());
  std::vector<PointPair> line;
  for (int i = 0; i < 20; ++i) line.push_back({{1.0 * i, 0.0, 0.0}, {0.0, 1.0 * i, 0.0}});
  const RansacResult on_line = *FindRigidConsensus(line, {.max_iterations = 500}, Stop{});
  EXPECT_FALSE(on_line.T_target_source.has_value());
  EXPECT_TRUE(on_line.inliers.empty());
  const std::vector<PointPair> equal(20, PointPair{{1.0, 2.0, 3.0}, {4.0, 5.0, 6.0}});
  EXPECT_FALSE(FindRigidConsensus(equal, {.max_iterations = 500}, Stop{})->T_target_source.has_value());
  EXPECT_TRUE(FindRigidConsensus(Pairs(3, 1), {}, Stop{})->T_target_source.has_value());
}

TEST(RansacTest, RefusesBadOptionsAndPoints) {
  const std::vector<PointPair> pairs = Pairs(10, 1);
  for (const RansacOptions& options :
       {RansacOptions{.inlier_threshold_m = 0.0}, RansacOptions{.inlier_threshold_m = std::nan("")},
        RansacOptions{.max_iterations = 0}, RansacOptions{.confidence = 1.0}, RansacOptions{.confidence = 0.0}}) {
    EXPECT_EQ(FindRigidConsensus(pairs, options, Stop{}).status().code(), absl::StatusCode::kInvalidArgument);
  }
  std::vector<PointPair> bad = pairs;
  bad[4].source.z() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(FindRigidConsensus(bad, {}, Stop{}).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST(RansacTest, ObeysTheStop) {
  const std::vector<PointPair> pairs = Pairs(300, 10);
  std::stop_source source;
  source.request_stop();
  EXPECT_EQ(FindRigidConsensus(pairs, {}, Stop{source.get_token(), {}}).status().code(), absl::StatusCode::kCancelled);
  const auto past = std::chrono::steady_clock::now();
  const RansacResult late = *FindRigidConsensus(pairs, {}, Stop{{}, past});
  EXPECT_FALSE(late.is_complete);
  EXPECT_EQ(late.num_iterations, 0);
  const auto start = std::chrono::steady_clock::now();
  const RansacOptions endless{.inlier_threshold_m = 0.01, .max_iterations = std::numeric_limits<int>::max()};
  const RansacResult cut =
      *FindRigidConsensus(Pairs(300, 1000), endless, Stop{{}, start + std::chrono::milliseconds(20)});
  EXPECT_FALSE(cut.is_complete);
  EXPECT_GT(cut.num_iterations, 0);
}

TEST(LogFalseAlarmsTest, CountsWhatChanceExplains) {
  // (5 - 3) * C(5, 4) * C(4, 3) * 0.1
  EXPECT_NEAR(LogFalseAlarms(5, 4, 0.1), std::log(2.0 * 5.0 * 4.0 * 0.1), 1e-12);
  // (100 - 3) * C(100, 5) * C(5, 3) * 0.01^2
  EXPECT_NEAR(LogFalseAlarms(100, 5, 0.01), std::log(97.0 * 75287520.0 * 10.0 * 1e-4), 1e-9);
  EXPECT_EQ(LogFalseAlarms(100, 3, 0.001), std::numeric_limits<double>::infinity());
  for (int k = 10; k < 60; ++k) EXPECT_LT(LogFalseAlarms(100, k + 1, 0.01), LogFalseAlarms(100, k, 0.01)) << k;
  EXPECT_LT(LogFalseAlarms(100, 20, 0.01), std::log(1e-3));
  EXPECT_GT(LogFalseAlarms(100, 6, 0.01), std::log(1e-3));
}

}  // namespace
}  // namespace curvereg
