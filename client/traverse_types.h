// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What a server tells of a traverse. Poses, origins and priors are those of core/mapping/trajectory.h.
#ifndef CURVEREG_CLIENT_TRAVERSE_TYPES_H_
#define CURVEREG_CLIENT_TRAVERSE_TYPES_H_

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/mapping/trajectory.h"
#include "core/methods/registration_options.h"
#include "core/methods/registration_result.h"

namespace curvereg {

struct TraverseSettings {
  RegistrationOptions registration;  // prior, cancellation, deadline and limits stay behind
  int reorder_window = 0;            // scans may come this many sequence numbers late; 0: in order only
  bool optimize_on_the_fly = false;  // not only when asked to
};

struct RemoteTraverse {
  std::string name;  // traverses/...
  TraverseSettings settings;
  std::chrono::system_clock::time_point create_time;
  uint64_t next_sequence_number = 0;  // least one not yet acknowledged
  uint64_t num_registered_scans = 0;
  int num_segments = 0;
  uint64_t trajectory_version = 0;
  double path_length_m = 0.0;
};

// A registration as it travels over narrow links. Measures are -1 where not computed.
struct LinkSummary {
  uint64_t source = 0;  // sequence numbers
  uint64_t target = 0;
  bool loop_closure = false;
  bool accepted = false;
  std::vector<Reason> reasons;                    // why not
  std::optional<RigidTransform> T_target_source;  // rotation to float32
  std::optional<Vector6d> sigma;                  // standard deviations (rotation [rad], translation [m])
  double overlap = -1.0;                          // the lesser of the two
  double residual_rmse_m = -1.0;
  double runner_up_ratio = -1.0;
  double seconds = 0.0;  // wall time of the registration
};

struct ScanResult {
  uint64_t sequence_number = 0;
  TrajectoryPose pose;                       // when it was registered
  std::vector<LinkSummary> links;            // that were tried, accepted or not
  std::optional<RegistrationResult> result;  // of the link that decided the pose
  double latency_s = 0.0;                    // from the scan's acknowledgement to the answer
};

struct TrajectoryRevision {
  uint64_t version = 0;
  std::vector<TrajectoryPose> poses;  // those that changed
};

struct SegmentsJoined {
  int segment = 0;         // the one that remains
  int joined_segment = 0;  // the one that ended
  RigidTransform T_segment_joined = RigidTransform::Identity();
};

struct LinksFound {
  std::vector<LinkSummary> links;
};

struct TraverseEvent {
  uint64_t number = 0;  // without gaps, from 0
  std::chrono::system_clock::time_point time;
  std::variant<ScanResult, TrajectoryRevision, SegmentsJoined, LinksFound> what;
};

struct RemoteTrajectory {
  uint64_t version = 0;
  std::vector<TrajectoryPose> poses;  // in order of sequence numbers
};

struct OptimizationOutcome {
  uint64_t version = 0;
  int num_links = 0;
  int num_loop_closures = 0;
  int num_rejected_links = 0;
  double max_translation_change_m = 0.0;
  bool converged = true;  // false: the poses still moved when the steps ran out
};

}  // namespace curvereg

#endif  // CURVEREG_CLIENT_TRAVERSE_TYPES_H_
