// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What a registration answers: the transform and the evidence to believe it or not. Born rejected ("not run").
#ifndef CURVEREG_CORE_METHODS_REGISTRATION_RESULT_H_
#define CURVEREG_CORE_METHODS_REGISTRATION_RESULT_H_

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/rigid_transform.h"

namespace curvereg {

// Why a pose is not to be believed. A closed list: the wire, the metrics and the documentation carry the same names.
enum class Reason {
  kNotRun,               // the result was never filled in
  kTooFewPoints,         // too few usable points left in a scan after filtering
  kTooFewFeatures,       // too few key points to match
  kNoConsensus,          // matches agree on no pose
  kResidualTooHigh,      // surfaces do not lie on each other
  kOverlapTooLow,        // the scans share too little ground
  kFreeSpaceViolated,    // one scan puts surface where the other saw through
  kAmbiguous,            // another, different pose explains the scans as well
  kDegenerateDirection,  // the scans leave a direction of the pose undetermined
  kDeadline,             // time ran out; the pose is the best so far
};

struct Verdict {
  bool accepted = false;
  std::vector<Reason> reasons = {Reason::kNotRun};  // why rejected; empty exactly when accepted
};

// A direction of the pose that the scans do not determine, in the target frame: unit vector of (rotation, translation).
struct DegenerateDirection {
  Vector6d direction = Vector6d::Zero();
  double sigma = 0.0;  // standard deviation along it [rad or m, mixed as in `direction`]; infinite when unobserved
};

// Counts and measures, summed or taken at the chosen pose; -1 where a method does not compute a measure.
struct Evidence {
  int64_t num_source_points = 0;  // finite points of the scan
  int64_t num_target_points = 0;
  int num_source_keypoints = 0;
  int num_target_keypoints = 0;
  int num_matches = 0;
  int num_inliers = 0;                 // matches that agree with the chosen hypothesis
  int num_hypotheses = 0;              // distinct poses tried
  int num_attempts = 0;                // rungs of the escalation ladder climbed
  double overlap_source = -1.0;        // share of the source's surface that the target saw, in [0, 1]
  double overlap_target = -1.0;        // share of the target's surface that the source saw, in [0, 1]
  double free_space_agreement = -1.0;  // 1 minus the share of points that lie where the other scan saw through
  double image_correlation = -1.0;     // normalised correlation of the two band-passed views under the pose, [-1, 1]
  double inlier_fraction = -1.0;       // share of overlapping surface elements within the residual gate, [0, 1]
  double residual_rmse_m = -1.0;       // of surface distances after the last iteration [m]
  double residual_median_m = -1.0;     // of |surface distance| [m]
  double residual_p90_m = -1.0;
  // Confidence of the surest different pose over that of this one, >= 0; above 1 when the other looked surer.
  double runner_up_ratio = -1.0;
};

struct StageTime {
  std::string stage;
  double seconds = 0.0;
};

struct RegistrationResult {
  RigidTransform T_target_source = RigidTransform::Identity();  // meaningful only when has_pose
  bool has_pose = false;
  Matrix6d covariance = Matrix6d::Zero();  // of (rotation [rad], translation [m]), left perturbation, target frame
  bool has_covariance = false;
  Verdict verdict;
  std::vector<DegenerateDirection> degenerate_directions;
  Evidence evidence;
  std::vector<StageTime> stage_times;  // wall seconds in order of first execution; nested stages are not listed twice
  double total_seconds = 0.0;
  uint64_t seed = 0;
  std::string options_digest;
  std::string source_digest;
  std::string target_digest;
  std::string build_id;
};

}  // namespace curvereg

#endif  // CURVEREG_CORE_METHODS_REGISTRATION_RESULT_H_
