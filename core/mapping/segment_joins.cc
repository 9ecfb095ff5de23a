// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/segment_joins.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace curvereg {
namespace {

// Two segments and how one lies in the other, as one link says.
struct Connection {
  int lower = 0;
  int upper = 0;
  RigidTransform T_lower_upper = RigidTransform::Identity();
  Eigen::Vector3d place_upper = Eigen::Vector3d::Zero();  // of the link's scan there
  int num_agreeing = 0;                                   // links that say the same, this one included
};

std::vector<Connection> ConnectionsOf(const Traverse& traverse, const std::set<size_t>& excluded_links) {
  std::vector<Connection> connections;
  for (size_t i = 0; i < traverse.links.size(); ++i) {
    const TraverseLink& link = traverse.links[i];
    if (!link.result.verdict.accepted || excluded_links.contains(i) || !JoinsSegments(traverse, i)) continue;
    const TrajectoryPose& source = traverse.poses[link.source];
    const TrajectoryPose& target = traverse.poses[link.target];
    const RigidTransform T_target_source =
        target.T_segment_scan * *link.result.T_target_source * source.T_segment_scan.inverse();
    if (target.segment < source.segment) {
      connections.push_back({target.segment, source.segment, T_target_source, source.T_segment_scan.translation()});
    } else {
      connections.push_back(
          {source.segment, target.segment, T_target_source.inverse(), target.T_segment_scan.translation()});
    }
  }
  return connections;
}

// Agreement is tested half-way between the two links' scans, not at the origin of a segment that may be far away: there
// a thousandth of a radian is a metre per kilometre. The limits of 1 m and 0.1 rad distinguish similar places and allow
// for the drift of segments.
bool Agree(const Connection& a, const Connection& b) {
  constexpr double kSameM = 1.0;
  constexpr double kSameRad = 0.1;
  if (a.lower != b.lower || a.upper != b.upper) return false;
  const Eigen::Vector3d place_upper = 0.5 * (a.place_upper + b.place_upper);
  const double distance_m = (a.T_lower_upper * place_upper - b.T_lower_upper * place_upper).norm();
  return distance_m < kSameM && Difference(a.T_lower_upper, b.T_lower_upper).rotation_rad < kSameRad;
}

}  // namespace

bool JoinsSegments(const Traverse& traverse, size_t link) {
  return traverse.poses[traverse.links[link].source].segment != traverse.poses[traverse.links[link].target].segment;
}

SegmentPlaces PlaceSegments(const Traverse& traverse, const std::set<size_t>& excluded_links) {
  SegmentPlaces places;
  for (const TrajectoryPose& pose : traverse.poses) places[pose.segment].root = pose.segment;
  std::vector<Connection> connections = ConnectionsOf(traverse, excluded_links);
  for (Connection& connection : connections) {
    connection.num_agreeing = static_cast<int>(std::count_if(
        connections.begin(), connections.end(), [&](const Connection& other) { return Agree(connection, other); }));
  }
  std::stable_sort(connections.begin(), connections.end(),
                   [](const Connection& a, const Connection& b) { return a.num_agreeing > b.num_agreeing; });
  for (const Connection& connection : connections) {
    const SegmentPlace lower = places.at(connection.lower);
    const SegmentPlace upper = places.at(connection.upper);
    if (lower.root == upper.root) continue;
    const RigidTransform T_of_roots =
        lower.T_root_segment * connection.T_lower_upper * upper.T_root_segment.inverse();  // lower's from upper's
    const bool lower_stays = lower.root < upper.root;
    const RigidTransform T_new_old = lower_stays ? T_of_roots : T_of_roots.inverse();
    const int ended = lower_stays ? upper.root : lower.root;
    const int staying = lower_stays ? lower.root : upper.root;
    for (auto& [segment, place] : places) {
      if (place.root == ended) place = {staying, T_new_old * place.T_root_segment};
    }
  }
  return places;
}

bool SameJoins(const SegmentPlaces& a, const SegmentPlaces& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& one, const auto& other) {
    return one.first == other.first && one.second.root == other.second.root;
  });
}

}  // namespace curvereg
