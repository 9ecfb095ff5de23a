// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// START HERE: where the rover is, scan by scan. TrackScan answers quickly, FindLinks looks around afterwards,
// FindLoopClosures finds places that the path came back to, and ReviseTraverse makes all of it one trajectory. Each is
// a function of the traverse so far; the Append and Apply functions change it.
#ifndef CURVEREG_CORE_MAPPING_TRACKING_H_
#define CURVEREG_CORE_MAPPING_TRACKING_H_

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/stop.h"
#include "core/mapping/pose_graph.h"
#include "core/mapping/trajectory.h"
#include "core/methods/prepared_scan.h"
#include "core/methods/registration_options.h"

namespace curvereg {

// Kept scans of the traverse by sequence number, prepared; from a cache or prepared anew.
using TraverseScanLoader =
    std::function<absl::StatusOr<std::shared_ptr<const PreparedScan>>(uint64_t sequence_number, const Stop& stop)>;

// A scan as it comes; its sequence number is the number of poses so far.
struct TraverseScan {
  std::shared_ptr<const PreparedScan> scan;
  std::optional<int64_t> time_ns;
  std::optional<Prior> prior;  // motion since the scan before: T_target_source with the scan before as target
};

struct TrackingOptions {
  RegistrationOptions registration;  // its prior is replaced by what the traverse knows
  int num_tracking_neighbours = 2;   // kept scans tried beside the predecessor before a scan counts as unlinked
  int num_neighbours = 3;            // links looked for by FindLinks
  double max_neighbour_distance_m = 20.0;
  double loop_distance_m = 10.0;  // scans nearer than this, beyond what the poses' covariance allows
  int min_loop_gap = 10;          // sequence numbers between the ends of a loop closure
  int max_loop_candidates = 20;   // links tried by one FindLoopClosures by position, by one of either by look
  int max_places_compared = 40;   // kept scans looked at for a likely place where the position is unknown
  int max_places_in_all = 800;    // by one FindLoopClosures, shared out among segments
  // FindLinks looks for places of older segments with so many first scans of a segment and every so many-th after them.
  int num_scans_to_recognise = 3;
  int recognition_interval = 10;
  PoseGraphOptions pose_graph;
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
void AppendScan(Traverse& traverse, const TrackedScan& tracked, const std::optional<Prior>& prior);

// Further links of a tracked scan: with the nearest kept scans of its segment, and, as long as there are older
// segments, for its segment's first scans and some of the later ones, with places of the older segments that look alike
// (features of elevation views), until one is accepted. Only pairs that have no link yet. Scans that are not kept count
// for nothing. INVALID_ARGUMENT: no such scan; other errors as TrackScan.
absl::StatusOr<std::vector<TraverseLink>> FindLinks(const Traverse& traverse, uint64_t sequence_number,
                                                    const TraverseScanLoader& load, const TrackingOptions& options,
                                                    const Stop& stop = {});

// Links over the whole traverse: between scans of a segment far apart in sequence but near in place, and, by look, from
// each segment to older ones: with its first and last scan and two between, those of long segments first. Where there
// are so many segments that max_places_in_all does not suffice, each search compares fewer places, then short segments
// go without. Errors as TrackScan.
absl::StatusOr<std::vector<TraverseLink>> FindLoopClosures(const Traverse& traverse, const TraverseScanLoader& load,
                                                           const TrackingOptions& options, const Stop& stop = {});

struct SegmentJoin {
  int segment = 0;         // remains
  int joined_segment = 0;  // ended; its poses move over
  RigidTransform T_segment_joined = RigidTransform::Identity();
};

// The trajectory that agrees best with all accepted links and priors (OptimizePoseGraph). A pose is kRegistered when
// links that were not given up connect it with an earlier one, by whichever way, kPrior when odometry alone does.
// Segments are joined, never split: a part that one link holds is where that link says, for nothing contradicts it. Of
// links that contradict each other one is believed, as a rule; if all of them are given up, the part stays near where
// they would have it, and its covariance, a thousand times their deviations, says that it is not known.
struct TraverseRevision {
  std::vector<SegmentJoin> joins;         // segments that accepted links connect
  std::vector<TrajectoryPose> poses;      // those that changed, by sequence number
  int num_links = 0;                      // used
  int num_rejected_links = 0;             // accepted by registration, given up here
  double max_translation_change_m = 0.0;  // of poses that stayed in their segment
  bool converged = true;                  // false: the poses still moved when max_iterations was reached
};
absl::StatusOr<TraverseRevision> ReviseTraverse(const Traverse& traverse, const TrackingOptions& options,
                                                const Stop& stop = {});
// Makes the revised poses the traverse's own and counts its version up when any changed.
void ApplyRevision(Traverse& traverse, const TraverseRevision& revision);

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_TRACKING_H_
