// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/approximate_matching.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/base/parallel.h"

namespace curvereg {
namespace {

constexpr ApproximateMatchingOptions kExact{.epsilon = 0.0};

// Unit descriptors around a few centres, as descriptors of like places are.
Features RandomFeatures(int count, uint64_t seed) {
  std::mt19937_64 generator(seed);
  const auto uniform = [&] { return static_cast<float>(generator() >> 40U) * 0x1.0p-24F; };
  Features features;
  for (int i = 0; i < count; ++i) {
    features.keypoints.push_back({1.0F, 1.0F, 1 + i % 3, i % 2 == 0 ? 1.0F : -1.0F});
    features.orientations_rad.push_back(0.0F);
    Eigen::VectorXf descriptor(kDescriptorSize);
    for (int k = 0; k < kDescriptorSize; ++k) descriptor[k] = uniform() + ((k + i) % 5 == 0 ? 2.0F : 0.0F);
    descriptor.normalize();
    features.descriptors.insert(features.descriptors.end(), descriptor.begin(), descriptor.end());
  }
  return features;
}

float DistanceBetween(const Features& a, size_t i, const Features& b, size_t j) {
  float squared = 0.0F;
  for (int k = 0; k < kDescriptorSize; ++k) {
    const float difference = a.Descriptor(i)[k] - b.Descriptor(j)[k];
    squared += difference * difference;
  }
  return std::sqrt(squared);
}

size_t NearestOf(const Features& queries, size_t i, const Features& features) {
  size_t best = 0;
  for (size_t j = 1; j < features.size(); ++j) {
    if (DistanceBetween(queries, i, features, j) < DistanceBetween(queries, i, features, best)) best = j;
  }
  return best;
}

TEST(ApproximateMatchingTest, ExactSearchIsBruteForce) {
  const Features source = RandomFeatures(150, 1);
  const Features target = RandomFeatures(180, 2);
  std::vector<std::pair<int, int>> expected;
  for (size_t s = 0; s < source.size(); ++s) {
    const size_t t = NearestOf(source, s, target);
    if (NearestOf(target, t, source) == s) expected.emplace_back(s, t);
  }
  ASSERT_GT(expected.size(), 10U);
  const std::vector<Match> matches = *MatchApproximateMutualNearest(source, target, kExact, Stop{});
  ASSERT_EQ(matches.size(), expected.size());
  for (size_t i = 0; i < matches.size(); ++i) {
    EXPECT_EQ(std::pair(matches[i].source, matches[i].target), expected[i]);
    const float distance =
        DistanceBetween(source, static_cast<size_t>(matches[i].source), target, static_cast<size_t>(matches[i].target));
    EXPECT_NEAR(matches[i].distance, distance, 1e-5F);
  }
}

TEST(ApproximateMatchingTest, ErrorStaysWithinEpsilon) {
  const Features source = RandomFeatures(150, 3);
  const Features target = RandomFeatures(180, 4);
  for (const double epsilon : {0.5, 3.0, 100.0}) {
    const auto matches = MatchApproximateMutualNearest(source, target, {.epsilon = epsilon}, Stop{});
    ASSERT_TRUE(matches.ok());
    for (const Match& match : *matches) {
      const auto s = static_cast<size_t>(match.source);
      const float nearest = DistanceBetween(source, s, target, NearestOf(source, s, target));
      EXPECT_LE(match.distance, std::sqrt(1.0 + epsilon) * nearest + 1e-5);
    }
  }
}

TEST(ApproximateMatchingTest, AScanMatchesItself) {
  const Features features = RandomFeatures(100, 5);
  const std::vector<Match> matches = *MatchApproximateMutualNearest(features, features, {}, Stop{});
  ASSERT_EQ(matches.size(), features.size());
  for (const Match& match : matches) {
    EXPECT_EQ(match.source, match.target);
    EXPECT_EQ(match.distance, 0.0F);
  }
}

TEST(ApproximateMatchingTest, EmptySingleAndEqualDescriptors) {
  const Features some = RandomFeatures(5, 6);
  const Features none;
  EXPECT_TRUE(MatchApproximateMutualNearest(none, some, {}, Stop{})->empty());
  EXPECT_TRUE(MatchApproximateMutualNearest(some, none, {}, Stop{})->empty());
  EXPECT_EQ(MatchApproximateMutualNearest(RandomFeatures(1, 7), some, {}, Stop{})->size(), 1U);
  Features equal = RandomFeatures(200, 8);
  std::fill(equal.descriptors.begin(), equal.descriptors.end(), std::sqrt(1.0F / kDescriptorSize));
  const auto matches = MatchApproximateMutualNearest(equal, equal, {}, Stop{});
  ASSERT_TRUE(matches.ok());
  EXPECT_LE(matches->size(), equal.size());
}

TEST(ApproximateMatchingTest, SameMatchesAtAnyThreadCount) {
  const Features source = RandomFeatures(300, 9);
  const Features target = RandomFeatures(300, 10);
  const std::vector<Match> serial = *MatchApproximateMutualNearest(source, target, {}, Stop{});
  for (const int num_threads : {1, 2, 4}) {
    std::vector<Match> matches;
    WithThreadLimit(num_threads, [&] { matches = *MatchApproximateMutualNearest(source, target, {}, Stop{}); });
    ASSERT_EQ(matches.size(), serial.size()) << num_threads;
    for (size_t i = 0; i < matches.size(); ++i) {
      EXPECT_EQ(matches[i].source, serial[i].source);
      EXPECT_EQ(matches[i].target, serial[i].target);
      EXPECT_EQ(matches[i].distance, serial[i].distance);
    }
  }
}

TEST(ApproximateMatchingTest, ObeysTheStop) {
  const Features features = RandomFeatures(100, 11);
  std::stop_source source;
  source.request_stop();
  EXPECT_EQ(MatchApproximateMutualNearest(features, features, {}, Stop{source.get_token(), {}}).status().code(),
            absl::StatusCode::kCancelled);
  EXPECT_EQ(
      MatchApproximateMutualNearest(features, features, {}, Stop{{}, std::chrono::steady_clock::now()}).status().code(),
      absl::StatusCode::kDeadlineExceeded);
}

}  // namespace
}  // namespace curvereg
