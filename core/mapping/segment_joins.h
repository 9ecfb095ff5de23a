// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Which segments of a traverse accepted links connect, and where they lie in one another's frames.
#ifndef CURVEREG_CORE_MAPPING_SEGMENT_JOINS_H_
#define CURVEREG_CORE_MAPPING_SEGMENT_JOINS_H_

#include <algorithm>
#include <cstddef>
#include <map>
#include <numeric>
#include <set>
#include <vector>

#include "core/mapping/trajectory.h"

namespace curvereg {

// Union-find.
class DisjointSets {
 public:
  explicit DisjointSets(size_t size) : parent_(size) { std::iota(parent_.begin(), parent_.end(), size_t{0}); }
  size_t Find(size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  // False when they were one already.
  bool Unite(size_t i, size_t j) {
    const size_t root_i = Find(i);
    const size_t root_j = Find(j);
    parent_[std::max(root_i, root_j)] = std::min(root_i, root_j);
    return root_i != root_j;
  }

 private:
  std::vector<size_t> parent_;
};

struct SegmentPlace {
  int root = 0;  // the lowest number of the segments that are connected with this one
  RigidTransform T_root_segment = RigidTransform::Identity();
};
using SegmentPlaces = std::map<int, SegmentPlace>;  // by segment

// Places all segments by the accepted links between them, those of `excluded_links` (indices in Traverse::links) left
// out. Where the links between two segments contradict each other, the one that most others agree with counts; where
// segments are connected in circles, the pairs with most agreement. What is left over is for the optimisation.
SegmentPlaces PlaceSegments(const Traverse& traverse, const std::set<size_t>& excluded_links);

// Whether the link's scans are of different segments.
bool JoinsSegments(const Traverse& traverse, size_t link);

// Whether both connect the same segments, wherever they lie.
bool SameJoins(const SegmentPlaces& a, const SegmentPlaces& b);

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_SEGMENT_JOINS_H_
