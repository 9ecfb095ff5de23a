// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Which segments of a traverse accepted links connect, and where they lie in one another's frames.
#ifndef CURVEREG_CORE_MAPPING_SEGMENT_JOINS_H_
#define CURVEREG_CORE_MAPPING_SEGMENT_JOINS_H_

#include <cstddef>
#include <map>
#include <set>

#include "core/mapping/trajectory.h"

namespace curvereg {

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
