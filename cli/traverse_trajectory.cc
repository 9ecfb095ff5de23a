// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/traverse_trajectory.h"

#include <algorithm>
#include <map>

namespace curvereg::cli {

int LargestSegment(const std::vector<TrajectoryPose>& poses) {
  std::map<int, int> counts;
  for (const TrajectoryPose& pose : poses) ++counts[pose.segment];
  const auto largest =
      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return largest == counts.end() ? 0 : largest->first;
}

std::vector<StampedPose> PosesOf(const std::vector<TrajectoryPose>& poses, int segment) {
  const bool has_times = std::all_of(poses.begin(), poses.end(), [segment](const TrajectoryPose& pose) {
    return pose.segment != segment || pose.time_ns.has_value();
  });
  std::vector<StampedPose> result;
  for (const TrajectoryPose& pose : poses) {
    if (pose.segment != segment) continue;
    const double time_s =
        has_times ? static_cast<double>(*pose.time_ns) * 1e-9 : static_cast<double>(pose.sequence_number);
    result.push_back({time_s, pose.T_segment_scan});
  }
  return result;
}

}  // namespace curvereg::cli
