// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A data set end to end: its scans tracked one after the other as a rover's drive, then optimised, and both
// trajectories and maps measured against the truth.
#ifndef CURVEREG_EVAL_EVALUATE_TRAVERSE_H_
#define CURVEREG_EVAL_EVALUATE_TRAVERSE_H_

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/mapping/tracking.h"
#include "eval/dataset.h"
#include "eval/scan_cache.h"
#include "eval/surface_thickness.h"
#include "eval/trajectory_metrics.h"

namespace curvereg {

// Poses of the scans in name order, and how good they are.
struct MeasuredTrajectory {
  std::vector<TrajectoryPose> poses;
  int num_segments = 0;
  int measured_segment = 0;
  // Of the segment with most scans that have a true pose, the earliest of several; the other scans are failures that
  // these figures do not hold. nullopt: no true poses.
  std::optional<TrajectoryErrors> errors;
  int num_measured = 0;                // with a true pose, in that segment
  SurfaceThickness::Result thickness;  // of the same segment's map
};

struct TraverseEvaluation {
  std::string dataset;  // folder
  Method method = Method::kCurvelet;
  int num_scans = 0;
  MeasuredTrajectory tracked;                              // as TrackScan answered
  MeasuredTrajectory optimised;                            // after loop closures and ReviseTraverse
  std::optional<SurfaceThickness::Result> true_thickness;  // of the map at the true poses: what the scanner allows
  std::vector<TraverseLink> links;
  int num_accepted_links = 0;
  int num_accepted_wrong_links = 0;   // beyond SuccessBounds of the truth
  int num_given_up_links = 0;         // by the optimisation
  bool converged = true;              // whether the optimisation did
  std::vector<double> track_seconds;  // per scan: preparation and TrackScan
  double optimise_seconds = 0.0;      // FindLoopClosures and ReviseTraverse
};

struct TraverseEvaluationOptions {
  TrackingOptions tracking;
  ScanLoader load_scan;  // required
  std::function<void(int num_done, const std::string&)>
      progress;  // scans tracked and the name of the last; may be empty
};

// Errors: those of reading and preparing scans, CANCELLED. INVALID_ARGUMENT: fewer than two scans.
absl::StatusOr<TraverseEvaluation> EvaluateTraverse(const Dataset& dataset, const TraverseEvaluationOptions& options);

}  // namespace curvereg

#endif  // CURVEREG_EVAL_EVALUATE_TRAVERSE_H_
