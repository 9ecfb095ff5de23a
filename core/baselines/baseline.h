// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What the paper's two baselines share: options, result, limits. Both are made of PCL's parts and know no verdict: they
// answer the pose that their last step, ICP, ends with. Frames and units as in core/scan/scan.h.
//
// Cost: minutes per pair of 200k-point scans, on one thread; they exist to be compared with, not to be used.
// Determinism: same scans, options and seed, same bytes. Nothing is drawn from PCL's or the process's shared
// generators, so concurrent calls do not disturb each other.
// Stopping: every neighbour search asks `stop`, and after a request finds nothing, which ends PCL's loops within
// milliseconds (32 ms at most in trials with 124k points). Not interruptible: building the kd-tree of a cloud, 40 ms
// for 224k points and 250 ms for 1M; one pass of the voxel grid.
#ifndef CURVEREG_CORE_BASELINES_BASELINE_H_
#define CURVEREG_CORE_BASELINES_BASELINE_H_

#include <cstdint>
#include <optional>

#include "absl/status/status.h"
#include "core/base/rigid_transform.h"
#include "core/base/stop.h"
#include "core/methods/registration_result.h"

namespace curvereg {

// The defaults are the paper's parameters, where it gives them.
struct BaselineOptions {
  double voxel_size_m = 0.0;      // > 0: one mean point per voxel before anything else; 0: all points, as the paper
  double normal_radius_m = 1.0;   // neighbourhood of a normal; the paper gives one radius for all
  double feature_radius_m = 1.0;  // neighbourhood of an FPFH descriptor and of a Harris response
  double min_sample_distance_m = 2.5;     // between the three points of a SAC-IA sample
  int correspondence_randomness = 20;     // SAC-IA draws each match among that many nearest descriptors
  double ransac_threshold_m = 15.0;       // RANSAC on key point matches: larger distances are outliers
  double icp_max_correspondence_m = 5.0;  // ICP, and the error of SAC-IA: larger distances count as this one
  int max_iterations = 100;               // of SAC-IA, of RANSAC and of ICP, each
  double epsilon = 1e-6;  // ICP ends when a step is shorter: squared translation [m^2], 1 - cos(rotation)
  uint64_t seed = 1;
  Stop stop;  // cancelled: absl::CancelledError; past the deadline: the best pose so far
};

// INVALID_ARGUMENT names the first option that is out of range or not finite.
absl::Status Validate(const BaselineOptions& options);

struct BaselineResult {
  std::optional<RigidTransform> T_target_source;
  bool converged = false;         // ICP ended because its steps became small
  std::optional<Reason> failure;  // why there is no pose (kTooFewFeatures, kNoConsensus), or kDeadline
  int num_source_keypoints = 0;   // points that have a descriptor
  int num_target_keypoints = 0;
  int num_matches = 0;     // samples tried by SAC-IA; matched key points of Harris
  int num_inliers = 0;     // source points with a partner at the last ICP step; before ICP: inliers of RANSAC
  int num_iterations = 0;  // of ICP
  std::optional<double> residual_rmse_m;  // of those partners' distances; none before ICP
};

}  // namespace curvereg

#endif  // CURVEREG_CORE_BASELINES_BASELINE_H_
