// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/matching.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tests/testing/same_bytes.h"
#include "tests/testing/scenes.h"

namespace curvereg {
namespace {

struct Group {
  int level;
  bool positive;
};

// Random unit descriptors without negative entries, in the given groups in turn.
Features RandomFeatures(size_t count, uint64_t seed, const std::vector<Group>& groups) {
  testing::Random random(seed);
  Features features;
  for (size_t i = 0; i < count; ++i) {
    const Group& group = groups[i % groups.size()];
    features.keypoints.push_back({.level = group.level, .response = group.positive ? 1.0F : -1.0F});
    features.orientations_rad.push_back(0.0F);
    std::vector<float> descriptor(kDescriptorSize);
    for (float& value : descriptor) value = static_cast<float>(random.Uniform());
    const float length = std::sqrt(std::inner_product(descriptor.begin(), descriptor.end(), descriptor.begin(), 0.0F));
    for (const float value : descriptor) features.descriptors.push_back(value / length);
  }
  return features;
}

double Distance(const float* a, const float* b) {
  double squared = 0.0;
  for (int i = 0; i < kDescriptorSize; ++i) squared += std::pow(static_cast<double>(a[i]) - b[i], 2);
  return std::sqrt(squared);
}

bool MayMatch(const Keypoint& a, const Keypoint& b) {
  return a.level == b.level && (a.response > 0.0F) == (b.response > 0.0F);
}

// Index in `others` nearest to feature i of `features`, -1 when none may match.
int Nearest(const Features& features, size_t i, const Features& others) {
  int best = -1;
  for (size_t j = 0; j < others.size(); ++j) {
    if (!MayMatch(features.keypoints[i], others.keypoints[j])) continue;
    if (best < 0 || Distance(features.Descriptor(i), others.Descriptor(j)) <
                        Distance(features.Descriptor(i), others.Descriptor(static_cast<size_t>(best)))) {
      best = static_cast<int>(j);
    }
  }
  return best;
}

const std::vector<Group> kGroups = {{1, true}, {1, false}, {3, true}};

TEST(MatchMutualNearestTest, EqualsExhaustiveSearch) {
  const Features source = RandomFeatures(151, 1, kGroups);
  const Features target = RandomFeatures(90, 2, kGroups);
  const auto matches = MatchMutualNearest(source, target);
  std::vector<std::pair<int, int>> expected;
  for (size_t i = 0; i < source.size(); ++i) {
    const int j = Nearest(source, i, target);
    if (j >= 0 && Nearest(target, static_cast<size_t>(j), source) == static_cast<int>(i)) {
      expected.emplace_back(static_cast<int>(i), j);
    }
  }
  ASSERT_GT(expected.size(), 10U);
  ASSERT_EQ(matches.size(), expected.size());
  for (size_t k = 0; k < matches.size(); ++k) {
    EXPECT_EQ(std::pair(matches[k].source, matches[k].target), expected[k]);
    EXPECT_NEAR(matches[k].distance,
                Distance(source.Descriptor(static_cast<size_t>(matches[k].source)),
                         target.Descriptor(static_cast<size_t>(matches[k].target))),
                1e-3);
  }
}

TEST(MatchMutualNearestTest, IsSymmetric) {
  const Features source = RandomFeatures(100, 3, kGroups);
  const Features target = RandomFeatures(120, 4, kGroups);
  const auto forward = MatchMutualNearest(source, target);
  auto backward = MatchMutualNearest(target, source);
  std::sort(backward.begin(), backward.end(), [](const Match& a, const Match& b) { return a.target < b.target; });
  ASSERT_EQ(forward.size(), backward.size());
  for (size_t k = 0; k < forward.size(); ++k) {
    EXPECT_EQ(forward[k].source, backward[k].target);
    EXPECT_EQ(forward[k].target, backward[k].source);
  }
}

TEST(MatchMutualNearestTest, FeaturesMatchThemselves) {
  const Features features = RandomFeatures(77, 5, kGroups);
  const auto matches = MatchMutualNearest(features, features);
  ASSERT_EQ(matches.size(), features.size());
  for (size_t i = 0; i < matches.size(); ++i) {
    EXPECT_EQ(matches[i].source, static_cast<int>(i));
    EXPECT_EQ(matches[i].target, static_cast<int>(i));
    EXPECT_NEAR(matches[i].distance, 0.0F, 1e-3F);
  }
}

TEST(MatchMutualNearestTest, OtherLevelsAndSignsNeverMatch) {
  const Features hills = RandomFeatures(10, 6, {{1, true}});
  EXPECT_TRUE(MatchMutualNearest(hills, RandomFeatures(10, 6, {{1, false}})).empty());
  EXPECT_TRUE(MatchMutualNearest(hills, RandomFeatures(10, 6, {{2, true}})).empty());
  EXPECT_EQ(MatchMutualNearest(hills, RandomFeatures(10, 6, {{1, true}})).size(), 10U);
}

TEST(MatchMutualNearestTest, EqualDescriptorsMatchAtMostOnce) {
  Features features = RandomFeatures(5, 7, {{1, true}});
  for (size_t i = 1; i < 5; ++i) {
    std::copy_n(features.descriptors.begin(), kDescriptorSize,
                features.descriptors.begin() + 128 * static_cast<int>(i));
  }
  EXPECT_EQ(MatchMutualNearest(features, features).size(), 1U);
}

TEST(MatchMutualNearestTest, EmptyInputGivesNoMatches) {
  const Features features = RandomFeatures(5, 8, kGroups);
  EXPECT_TRUE(MatchMutualNearest({}, {}).empty());
  EXPECT_TRUE(MatchMutualNearest(features, {}).empty());
  EXPECT_TRUE(MatchMutualNearest({}, features).empty());
}

TEST(MatchMutualNearestTest, SameBytesAtAnyThreadCount) {
  const Features source = RandomFeatures(151, 1, kGroups);
  const Features target = RandomFeatures(90, 2, kGroups);
  testing::ExpectSameBytesAtAnyThreadCount([&](testing::ByteLog& log) {
    for (const Match& match : MatchMutualNearest(source, target)) {
      log.Add(match.source);
      log.Add(match.target);
      log.Add(match.distance);
    }
  });
}

}  // namespace
}  // namespace curvereg
