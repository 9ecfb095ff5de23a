// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The pose of a new scan in its traverse, at once: a registration against its predecessor, else against the nearest
// kept scans, else the prior, else a new segment.
#ifndef CURVEREG_CORE_MAPPING_TRACK_SCAN_H_
#define CURVEREG_CORE_MAPPING_TRACK_SCAN_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/stop.h"
#include "core/mapping/tracking_options.h"
#include "core/mapping/trajectory.h"
#include "core/methods/prepared_scan.h"
#include "core/methods/registration_options.h"

namespace curvereg {

// A scan as it comes; its sequence number is the number of poses so far.
struct TraverseScan {
  std::shared_ptr<const PreparedScan> scan;
  std::optional<int64_t> time_ns;
  std::optional<Prior> prior;  // motion since the scan before: T_target_source with the scan before as target
};

// What became of a scan. A rejected link is never bridged silently: then the pose is carried by the prior (kPrior), or
// a new segment begins (kSegmentStart).
struct TrackedScan {
  TrajectoryPose pose;
  std::vector<TraverseLink> links;  // tried, in order
  int deciding_link = -1;           // index in `links` of the one that gave the pose; -1: none did
};

// Registers the scan against its predecessor: one registration in the common case, whatever the traverse's length.
// Where that is rejected, against the nearest kept scans. A prior with covariance gates each of them, and carries the
// pose when all are rejected; a prior without one is a hypothesis and carries nothing. Scans for which `load` says
// NOT_FOUND are not kept and passed over, fifty at most. Errors: those of `load` and of registrations that could not be
// done, CANCELLED, DEADLINE_EXCEEDED of `stop` (registration.time_budget_s rejects the link instead).
absl::StatusOr<TrackedScan> TrackScan(const Traverse& traverse, const TraverseScan& scan,
                                      const TraverseScanLoader& load, const TrackingOptions& options,
                                      const Stop& stop = {});
// The pose of a scan that no registration placed: carried by a prior that has a covariance, else the first of a new
// segment.
TrajectoryPose PoseWithoutLink(const Traverse& traverse, const std::optional<int64_t>& time_ns,
                               const std::optional<Prior>& prior);

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_TRACK_SCAN_H_
