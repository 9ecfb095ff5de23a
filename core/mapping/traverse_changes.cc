// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/traverse_changes.h"

#include <algorithm>

namespace curvereg {

void AppendScan(Traverse& traverse, const TrackedScan& tracked, const std::optional<Prior>& prior) {
  traverse.poses.push_back(tracked.pose);
  traverse.priors.push_back(prior);
  traverse.links.insert(traverse.links.end(), tracked.links.begin(), tracked.links.end());
  traverse.num_segments = std::max(traverse.num_segments, tracked.pose.segment + 1);
}

void ApplyRevision(Traverse& traverse, const TraverseRevision& revision) {
  for (const TrajectoryPose& pose : revision.poses) traverse.poses.at(pose.sequence_number) = pose;
  if (!revision.poses.empty()) ++traverse.version;
}

}  // namespace curvereg
