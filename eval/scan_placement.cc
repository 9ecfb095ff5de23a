// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/scan_placement.h"

#include <algorithm>
#include <cstddef>
#include <deque>

namespace curvereg {
namespace {

struct Link {
  int to = 0;
  RigidTransform T_from_to = RigidTransform::Identity();
};
using Links = std::vector<std::vector<Link>>;  // by the scan they start from

Links LinksOf(int num_scans, std::span<const RelativePose> edges) {
  Links links(static_cast<std::size_t>(num_scans));
  for (const RelativePose& edge : edges) {
    links[static_cast<std::size_t>(edge.target)].push_back({edge.source, edge.T_target_source});
    links[static_cast<std::size_t>(edge.source)].push_back({edge.target, edge.T_target_source.inverse()});
  }
  return links;
}

void PlaceGroup(int root, const RigidTransform& T_world_root, const Links& links, ScanPlacement& placement) {
  placement.T_world_scan[static_cast<std::size_t>(root)] = T_world_root;
  std::deque<int> frontier = {root};
  while (!frontier.empty()) {
    const auto from = static_cast<std::size_t>(frontier.front());
    frontier.pop_front();
    for (const Link& link : links[from]) {
      auto& T_world_to = placement.T_world_scan[static_cast<std::size_t>(link.to)];
      if (T_world_to) continue;
      T_world_to = *placement.T_world_scan[from] * link.T_from_to;
      placement.parent[static_cast<std::size_t>(link.to)] = static_cast<int>(from);
      frontier.push_back(link.to);
    }
  }
}

}  // namespace

ScanPlacement PlaceScans(int num_scans, std::span<const RelativePose> edges,
                         std::span<const std::optional<RigidTransform>> anchors) {
  const Links links = LinksOf(num_scans, edges);
  ScanPlacement placement;
  placement.T_world_scan.resize(static_cast<std::size_t>(num_scans));
  placement.parent.assign(static_cast<std::size_t>(num_scans), -1);
  for (std::size_t i = 0; i < anchors.size(); ++i) {
    if (!anchors[i] || links[i].empty() || placement.T_world_scan[i]) continue;
    PlaceGroup(static_cast<int>(i), *anchors[i], links, placement);
  }
  const bool any_anchor = std::any_of(anchors.begin(), anchors.end(), [](const auto& a) { return a.has_value(); });
  const auto first = std::find_if(links.begin(), links.end(), [](const auto& l) { return !l.empty(); });
  if (!any_anchor && first != links.end()) {
    PlaceGroup(static_cast<int>(first - links.begin()), RigidTransform::Identity(), links, placement);
  }
  return placement;
}

}  // namespace curvereg
