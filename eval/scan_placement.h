// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Places scans in the world by chaining relative poses, for the trajectory and the merged map.
#ifndef CURVEREG_EVAL_SCAN_PLACEMENT_H_
#define CURVEREG_EVAL_SCAN_PLACEMENT_H_

#include <optional>
#include <span>
#include <vector>

#include "core/base/rigid_transform.h"

namespace curvereg {

struct RelativePose {
  int source = 0;  // scan index
  int target = 0;
  RigidTransform T_target_source = RigidTransform::Identity();
};

struct ScanPlacement {
  std::vector<std::optional<RigidTransform>> T_world_scan;  // one per scan; nullopt: not connected to a placed scan
  std::vector<int>
      parent;  // one per scan: the scan it was chained to; -1 for the first of a chain and for unplaced ones
};

// Breadth first over `edges` (used both ways; earlier edges first, so the fewest links are chained). In each connected
// group the lowest scan with an anchor stands at its anchor. Without any anchor the group of the lowest connected scan
// stands at the identity and other groups stay unplaced. Scans without an edge stay unplaced.
// Preconditions: indices in [0, num_scans); anchors is empty or has num_scans entries.
ScanPlacement PlaceScans(int num_scans, std::span<const RelativePose> edges,
                         std::span<const std::optional<RigidTransform>> anchors);

}  // namespace curvereg

#endif  // CURVEREG_EVAL_SCAN_PLACEMENT_H_
