// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What the steps of tracking share: the scans they may ask for, and their options.
#ifndef CURVEREG_CORE_MAPPING_TRACKING_OPTIONS_H_
#define CURVEREG_CORE_MAPPING_TRACKING_OPTIONS_H_

#include <cstdint>
#include <functional>
#include <memory>

#include "absl/status/statusor.h"
#include "core/base/stop.h"
#include "core/mapping/pose_graph.h"
#include "core/methods/prepared_scan.h"
#include "core/methods/registration_options.h"

namespace curvereg {

// Kept scans of the traverse by sequence number, prepared; from a cache or prepared anew.
using TraverseScanLoader =
    std::function<absl::StatusOr<std::shared_ptr<const PreparedScan>>(uint64_t sequence_number, const Stop& stop)>;

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

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_TRACKING_OPTIONS_H_
