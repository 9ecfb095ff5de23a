// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/approximate_matching.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <flann/flann.hpp>

#include "core/base/parallel.h"
#include "core/base/stop_status.h"

namespace curvereg {
namespace {

using Tree = flann::KDTreeSingleIndex<flann::L2<float>>;

constexpr size_t kBlock = 16;  // queries between two looks at the stop: milliseconds even among 10^5 features

struct Nearest {
  std::vector<int> index;  // -1 where the stop came first
  std::vector<float> squared_distance;
};

// FLANN's matrices are views of memory that may be written; here they are only read.
flann::Matrix<float> DescriptorRows(const Features& features, size_t begin, size_t count) {
  return {const_cast<float*>(features.Descriptor(begin)), count, kDescriptorSize};
}

// For each query the nearest of `features`, both not empty.
Nearest FindNearest(const Features& queries, const Features& features, const ApproximateMatchingOptions& options,
                    const Stop& stop) {
  Tree tree(DescriptorRows(features, 0, features.size()), flann::KDTreeSingleIndexParams(/*leaf_max_size=*/10));
  tree.buildIndex();
  flann::SearchParams params(flann::FLANN_CHECKS_UNLIMITED, static_cast<float>(options.epsilon));
  params.use_heap = flann::FLANN_False;
  Nearest nearest{std::vector<int>(queries.size(), -1), std::vector<float>(queries.size())};
  ParallelFor(static_cast<int>((queries.size() + kBlock - 1) / kBlock), [&](int block) {
    if (stop.Requested()) return;
    const size_t begin = static_cast<size_t>(block) * kBlock;
    const size_t count = std::min(kBlock, queries.size() - begin);
    flann::Matrix<int> indices(&nearest.index[begin], count, 1);
    flann::Matrix<float> distances(&nearest.squared_distance[begin], count, 1);
    tree.knnSearch(DescriptorRows(queries, begin, count), indices, distances, 1, params);
  });
  return nearest;
}

}  // namespace

absl::StatusOr<std::vector<Match>> MatchApproximateMutualNearest(const Features& source, const Features& target,
                                                                 const ApproximateMatchingOptions& options,
                                                                 const Stop& stop) {
  std::vector<Match> matches;
  if (source.size() == 0 || target.size() == 0) return matches;
  std::array<Nearest, 2> nearest;
  ParallelFor(2, [&](int direction) {
    if (direction == 0) nearest[0] = FindNearest(source, target, options, stop);
    if (direction == 1) nearest[1] = FindNearest(target, source, options, stop);
  });
  if (absl::Status status = StopStatus(stop, "matching"); !status.ok()) return status;
  for (size_t s = 0; s < source.size(); ++s) {
    const int t = nearest[0].index[s];
    if (nearest[1].index[static_cast<size_t>(t)] != static_cast<int>(s)) continue;
    matches.push_back({static_cast<int>(s), t, std::sqrt(nearest[0].squared_distance[s])});
  }
  return matches;
}

}  // namespace curvereg
