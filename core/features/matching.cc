// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/matching.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/parallel.h"
#include "core/base/simd.h"

namespace curvereg {
namespace {

constexpr int kTile = 4;  // target descriptors compared per pass over a source descriptor

// Dot products of `query` with every row of `rows` (num_rows x 128, padded to a multiple of kTile rows).
CURVEREG_DISPATCH void DotProducts(const float* query, const float* rows, int num_rows, float* products) {
  constexpr int kLanes = 16;
  for (int row = 0; row < num_rows; row += kTile) {
    float sums[kTile][kLanes] = {};
    const float* tile = rows + static_cast<size_t>(row) * kDescriptorSize;
    for (int k = 0; k < kDescriptorSize; k += kLanes) {
      for (int t = 0; t < kTile; ++t) {
        for (int lane = 0; lane < kLanes; ++lane) {
          sums[t][lane] += query[k + lane] * tile[t * kDescriptorSize + k + lane];
        }
      }
    }
    for (int t = 0; t < kTile; ++t) {
      float total = 0.0F;
      for (int lane = 0; lane < kLanes; ++lane) total += sums[t][lane];
      products[row + t] = total;
    }
  }
}

// Features that may match each other: one level, one sign.
struct Group {
  std::vector<int> source;
  std::vector<int> target;
};

std::vector<Group> GroupFeatures(const Features& source, const Features& target) {
  std::map<std::pair<int, bool>, Group> groups;
  const auto key = [](const Keypoint& keypoint) { return std::pair(keypoint.level, keypoint.response > 0.0F); };
  for (size_t i = 0; i < source.size(); ++i) groups[key(source.keypoints[i])].source.push_back(static_cast<int>(i));
  for (size_t i = 0; i < target.size(); ++i) groups[key(target.keypoints[i])].target.push_back(static_cast<int>(i));
  std::vector<Group> result;
  for (auto& [unused, group] : groups) {
    if (!group.source.empty() && !group.target.empty()) result.push_back(std::move(group));
  }
  return result;
}

std::vector<float> GatherPadded(const Features& features, const std::vector<int>& indices) {
  const size_t padded = (indices.size() + kTile - 1) / kTile * kTile;
  std::vector<float> rows(padded * kDescriptorSize, 0.0F);
  for (size_t i = 0; i < indices.size(); ++i) {
    std::copy_n(features.Descriptor(static_cast<size_t>(indices[i])), kDescriptorSize, &rows[i * kDescriptorSize]);
  }
  return rows;
}

std::vector<Match> MatchGroup(const Features& source, const Features& target, const Group& group) {
  const std::vector<float> rows = GatherPadded(target, group.target);
  std::vector<float> products(rows.size() / kDescriptorSize);
  struct Best {
    float product = -2.0F;
    int index = -1;
  };
  std::vector<Best> best_of_source(group.source.size());
  std::vector<Best> best_of_target(group.target.size());
  for (size_t s = 0; s < group.source.size(); ++s) {
    const float* query = source.Descriptor(static_cast<size_t>(group.source[s]));
    DotProducts(query, rows.data(), static_cast<int>(products.size()), products.data());
    Best& best = best_of_source[s];
    for (size_t t = 0; t < group.target.size(); ++t) {
      if (products[t] > best.product) best = {products[t], static_cast<int>(t)};
      if (products[t] > best_of_target[t].product) best_of_target[t] = {products[t], static_cast<int>(s)};
    }
  }
  std::vector<Match> matches;
  for (size_t s = 0; s < group.source.size(); ++s) {
    const Best& best = best_of_source[s];
    if (best.index < 0 || best_of_target[static_cast<size_t>(best.index)].index != static_cast<int>(s)) continue;
    const float distance = std::sqrt(std::max(0.0F, 2.0F - 2.0F * best.product));
    matches.push_back({group.source[s], group.target[static_cast<size_t>(best.index)], distance});
  }
  return matches;
}

}  // namespace

std::vector<Match> MatchMutualNearest(const Features& source, const Features& target) {
  const std::vector<Group> groups = GroupFeatures(source, target);
  std::vector<std::vector<Match>> found(groups.size());
  ParallelFor(static_cast<int>(groups.size()), [&](int i) {
    found[static_cast<size_t>(i)] = MatchGroup(source, target, groups[static_cast<size_t>(i)]);
  });
  std::vector<Match> matches;
  for (const std::vector<Match>& group : found) matches.insert(matches.end(), group.begin(), group.end());
  std::sort(matches.begin(), matches.end(), [](const Match& a, const Match& b) { return a.source < b.source; });
  return matches;
}

}  // namespace curvereg
