// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pose/consensus.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/testing/same_bytes.h"
#include "tests/testing/scenes.h"

namespace curvereg {
namespace {

struct Motion {
  double yaw_rad;
  Eigen::Vector2d shift;
};

struct Matched {
  std::vector<PlanarFeature> source;
  std::vector<PlanarFeature> target;
  std::vector<Match> matches;
};

// `count` matches that follow the motion up to 5 cm and 0.1 rad.
void AddInliers(const Motion& motion, int count, testing::Random& random, Matched& matched) {
  for (int i = 0; i < count; ++i) {
    const PlanarFeature s{{random.Uniform(-25.0, 25.0), random.Uniform(-25.0, 25.0)}, random.Uniform(-3.1, 3.1)};
    PlanarFeature t;
    t.position = Eigen::Rotation2Dd(motion.yaw_rad) * s.position + motion.shift;
    t.position += 0.05 * Eigen::Vector2d(random.Gaussian(), random.Gaussian());
    t.orientation_rad =
        std::remainder(s.orientation_rad + motion.yaw_rad + 0.1 * random.Gaussian(), 2.0 * std::numbers::pi);
    const int index = static_cast<int>(matched.source.size());
    matched.matches.push_back({index, index, 0.1F});
    matched.source.push_back(s);
    matched.target.push_back(t);
  }
}

void AddOutliers(int count, testing::Random& random, Matched& matched) {
  for (int i = 0; i < count; ++i) {
    const int index = static_cast<int>(matched.source.size());
    matched.matches.push_back({index, index, 0.1F});
    for (auto* features : {&matched.source, &matched.target}) {
      features->push_back({{random.Uniform(-30.0, 30.0), random.Uniform(-30.0, 30.0)}, random.Uniform(-3.1, 3.1)});
    }
  }
}

void ExpectMotion(const PlanarHypothesis& hypothesis, const Motion& motion) {
  EXPECT_LT(std::abs(std::remainder(hypothesis.yaw_rad - motion.yaw_rad, 2.0 * std::numbers::pi)), 0.003);
  EXPECT_LT((hypothesis.shift - motion.shift).norm(), 0.05);
}

TEST(FindPlanarHypothesesTest, RecoversTheMotionAmongSeventyPercentOutliers) {
  for (const Motion& motion : {Motion{0.7, {5.0, -3.0}}, {3.1, {0.0, 8.0}}, {-2.0, {-12.0, 1.0}}, {0.0, {0.0, 0.0}}}) {
    testing::Random random(17);
    Matched matched;
    AddOutliers(35, random, matched);
    AddInliers(motion, 30, random, matched);
    AddOutliers(35, random, matched);
    const auto hypotheses = FindPlanarHypotheses(matched.source, matched.target, matched.matches);
    ASSERT_FALSE(hypotheses.empty());
    ExpectMotion(hypotheses[0], motion);
    EXPECT_GE(hypotheses[0].inliers.size(), 28U);
    EXPECT_LE(hypotheses[0].inliers.size(), 32U);
    const auto is_true = [](int index) { return index >= 35 && index < 65; };
    EXPECT_GE(std::count_if(hypotheses[0].inliers.begin(), hypotheses[0].inliers.end(), is_true), 28);
    EXPECT_TRUE(std::is_sorted(hypotheses[0].inliers.begin(), hypotheses[0].inliers.end()));
  }
}

TEST(FindPlanarHypothesesTest, IndicesFollowTheMatches) {
  testing::Random random(5);
  const Motion motion{0.4, {2.0, 1.0}};
  Matched matched;
  AddInliers(motion, 12, random, matched);
  std::reverse(matched.target.begin(), matched.target.end());
  for (Match& match : matched.matches) match.target = 11 - match.target;
  const auto hypotheses = FindPlanarHypotheses(matched.source, matched.target, matched.matches);
  ASSERT_FALSE(hypotheses.empty());
  ExpectMotion(hypotheses[0], motion);
}

TEST(FindPlanarHypothesesTest, KeepsASecondMotionBehindTheFirst) {
  testing::Random random(23);
  const Motion first{0.5, {3.0, 0.0}};
  const Motion second{-1.5, {-8.0, 6.0}};
  Matched matched;
  AddInliers(second, 12, random, matched);
  AddInliers(first, 25, random, matched);
  AddOutliers(20, random, matched);
  const auto hypotheses = FindPlanarHypotheses(matched.source, matched.target, matched.matches);
  ASSERT_GE(hypotheses.size(), 2U);
  ExpectMotion(hypotheses[0], first);
  ExpectMotion(hypotheses[1], second);
}

TEST(FindPlanarHypothesesTest, AreDistinctAndSortedAndNoMoreThanAsked) {
  testing::Random random(31);
  Matched matched;
  AddOutliers(300, random, matched);
  ConsensusOptions options;
  options.min_inliers = 2;
  const auto hypotheses = FindPlanarHypotheses(matched.source, matched.target, matched.matches, options);
  ASSERT_GE(hypotheses.size(), 2U);
  EXPECT_LE(hypotheses.size(), 8U);
  for (size_t i = 0; i < hypotheses.size(); ++i) {
    EXPECT_GE(hypotheses[i].inliers.size(), 2U);
    for (size_t j = 0; j < i; ++j) {
      EXPECT_GE(hypotheses[j].inliers.size(), hypotheses[i].inliers.size());
      const double turn =
          std::abs(std::remainder(hypotheses[i].yaw_rad - hypotheses[j].yaw_rad, 2.0 * std::numbers::pi));
      EXPECT_TRUE(turn >= options.distinct_rad ||
                  (hypotheses[i].shift - hypotheses[j].shift).norm() >= options.distinct_m);
    }
  }
  options.max_hypotheses = 1;
  const auto best = FindPlanarHypotheses(matched.source, matched.target, matched.matches, options);
  ASSERT_EQ(best.size(), 1U);
}

TEST(FindPlanarHypothesesTest, NoPoseWithoutEnoughMatches) {
  testing::Random random(2);
  Matched matched;
  AddInliers({0.3, {1.0, 1.0}}, 2, random, matched);
  EXPECT_TRUE(FindPlanarHypotheses(matched.source, matched.target, matched.matches).empty());
  AddInliers({0.3, {1.0, 1.0}}, 1, random, matched);
  EXPECT_EQ(FindPlanarHypotheses(matched.source, matched.target, matched.matches).size(), 1U);
  EXPECT_TRUE(FindPlanarHypotheses({}, {}, {}).empty());
  EXPECT_TRUE(FindPlanarHypotheses(matched.source, matched.target, {}).empty());
}

TEST(FindPlanarHypothesesTest, EqualPositionsTakeTheYawOfTheirOrientations) {
  Matched matched;
  for (int i = 0; i < 5; ++i) {
    matched.source.push_back({{1.0, 2.0}, 0.2});
    matched.target.push_back({{4.0, 6.0}, 0.9});
    matched.matches.push_back({i, i, 0.1F});
  }
  const auto hypotheses = FindPlanarHypotheses(matched.source, matched.target, matched.matches);
  ASSERT_EQ(hypotheses.size(), 1U);
  EXPECT_NEAR(hypotheses[0].yaw_rad, 0.7, 1e-6);
  const Eigen::Vector2d moved = Eigen::Rotation2Dd(0.7) * Eigen::Vector2d(1.0, 2.0) + hypotheses[0].shift;
  EXPECT_LT((moved - Eigen::Vector2d(4.0, 6.0)).norm(), 1e-5);
}

TEST(FindPlanarHypothesesTest, OrientationsMustAgree) {
  testing::Random random(3);
  Matched matched;
  AddInliers({0.3, {1.0, 1.0}}, 10, random, matched);
  // Positions still follow one motion, but every feature is turned another way.
  for (size_t i = 0; i < 10; ++i) matched.target[i].orientation_rad += 0.6 * static_cast<double>(i);
  for (const PlanarHypothesis& h : FindPlanarHypotheses(matched.source, matched.target, matched.matches)) {
    EXPECT_LT(h.inliers.size(), 5U);
  }
}

TEST(FindPlanarHypothesesTest, SameBytesAtAnyThreadCount) {
  testing::Random random(41);
  Matched matched;
  AddInliers({0.3, {1.0, 1.0}}, 40, random, matched);
  AddOutliers(200, random, matched);
  testing::ExpectSameBytesAtAnyThreadCount([&](testing::ByteLog& log) {
    for (const PlanarHypothesis& h : FindPlanarHypotheses(matched.source, matched.target, matched.matches)) {
      log.Add(h.yaw_rad);
      log.Add(h.shift.data(), 2);
      log.Add(h.inliers);
    }
  });
}

}  // namespace
}  // namespace curvereg
