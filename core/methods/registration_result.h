// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The result of a registration: the transform, and the verdict with its evidence. Rejected ("not run") by default.
#ifndef CURVEREG_CORE_METHODS_REGISTRATION_RESULT_H_
#define CURVEREG_CORE_METHODS_REGISTRATION_RESULT_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/rigid_transform.h"

namespace curvereg {

// Why a pose is rejected. A closed list: the wire, the metrics and the documentation carry the same names.
enum class Reason {
  kNotRun,               // the result was never filled in
  kTooFewPoints,         // too few usable points left in a scan after filtering
  kTooFewFeatures,       // too few key points to match
  kNoConsensus,          // matches agree on no pose
  kResidualTooHigh,      // surfaces do not fit each other
  kOverlapTooLow,        // the scans share too little ground
  kFreeSpaceViolated,    // one scan has surface in the free space of the other
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

// Counts and measures, summed or taken at the chosen pose. A measure that the method does not compute has no value.
struct Evidence {
  int64_t num_source_points = 0;  // finite points of the scan
  int64_t num_target_points = 0;
  int num_source_keypoints = 0;
  int num_target_keypoints = 0;
  int num_matches = 0;
  int num_inliers = 0;                         // matches that agree with the chosen hypothesis
  int num_hypotheses = 0;                      // distinct poses tried
  int num_attempts = 0;                        // escalation steps run
  std::optional<double> overlap_source;        // share of the source's surface that the target saw, in [0, 1]
  std::optional<double> overlap_target;        // share of the target's surface that the source saw, in [0, 1]
  std::optional<double> free_space_agreement;  // 1 minus the share of points in the other scan's free space
  std::optional<double> image_correlation;     // of the two band-passed views under the pose, normalised, [-1, 1]
  std::optional<double> inlier_fraction;       // share of overlapping surfels within the residual gate, [0, 1]
  std::optional<double> residual_rmse_m;       // of surface distances after the last iteration [m]
  std::optional<double> residual_median_m;     // of |surface distance| [m]
  std::optional<double> residual_p90_m;        // 90th percentile of |surface distance| [m]
  // Confidence of the most confident different pose over that of this one, >= 0; above 1 when the other has more.
  std::optional<double> runner_up_ratio;
};

struct StageTime {
  std::string stage;
  double seconds = 0.0;
};

struct RegistrationResult {
  std::optional<RigidTransform> T_target_source;  // none: no pose was found; one is there when accepted
  // Of (rotation [rad], translation [m]), left perturbation, target frame. None: too little common surface, or a method
  // without covariances.
  std::optional<Matrix6d> covariance;
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
