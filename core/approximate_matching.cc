// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/approximate_matching.h"

#include <array>
#include <cmath>
#include <flann/flann.hpp>

#include "core/parallel.h"

namespace curvereg {
namespace {

struct Nearest {
  std::vector<int> index;
  std::vector<float> squared_distance;
};

// FLANN's matrices are views of memory that may be written; here they are only read.
flann::Matrix<float> DescriptorRows(const Features& features) {
  return {const_cast<float*>(features.descriptors.data()), features.size(), kDescriptorSize};
}

// For each query the nearest of `features`.
Nearest FindNearest(const Features& queries, const Features& features, const ApproximateMatchingOptions& options) {
  flann::KDTreeSingleIndex<flann::L2<float>> tree(DescriptorRows(features),
                                                  flann::KDTreeSingleIndexParams(/*leaf_max_size=*/10));
  tree.buildIndex();
  Nearest nearest{std::vector<int>(queries.size()), std::vector<float>(queries.size())};
  flann::Matrix<int> indices(nearest.index.data(), queries.size(), 1);
  flann::Matrix<float> distances(nearest.squared_distance.data(), queries.size(), 1);
  flann::SearchParams params(flann::FLANN_CHECKS_UNLIMITED, static_cast<float>(options.epsilon));
  params.use_heap = flann::FLANN_False;
  tree.knnSearch(DescriptorRows(queries), indices, distances, 1, params);
  return nearest;
}

}  // namespace

std::vector<Match> MatchApproximateMutualNearest(const Features& source, const Features& target,
                                                 const ApproximateMatchingOptions& options) {
  if (source.size() == 0 || target.size() == 0) return {};
  std::array<Nearest, 2> nearest;
  ParallelFor(2, [&](int direction) {
    if (direction == 0) nearest[0] = FindNearest(source, target, options);
    if (direction == 1) nearest[1] = FindNearest(target, source, options);
  });
  std::vector<Match> matches;
  for (size_t s = 0; s < source.size(); ++s) {
    const int t = nearest[0].index[s];
    if (nearest[1].index[static_cast<size_t>(t)] != static_cast<int>(s)) continue;
    matches.push_back({static_cast<int>(s), t, std::sqrt(nearest[0].squared_distance[s])});
  }
  return matches;
}

}  // namespace curvereg
