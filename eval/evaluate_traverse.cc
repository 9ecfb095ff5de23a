// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/evaluate_traverse.h"

#include <algorithm>
#include <chrono>
#include <list>
#include <map>
#include <memory>
#include <utility>

#include "core/base/parallel.h"
#include "eval/metrics.h"

namespace curvereg {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kPreparedScansKept = 32;  // most are asked for again soon after, as neighbours

double SecondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// The scans of a data set, prepared when first asked for.
class PreparedShelf {
 public:
  PreparedShelf(const Dataset& dataset, const TraverseEvaluationOptions& options)
      : dataset_(dataset), options_(options) {}

  absl::StatusOr<std::shared_ptr<const PreparedScan>> Get(uint64_t number, const Stop& stop) {
    const auto found =
        std::find_if(kept_.begin(), kept_.end(), [&](const Kept& kept) { return kept.number == number; });
    if (found != kept_.end()) {
      kept_.splice(kept_.begin(), kept_, found);
      return kept_.front().scan;
    }
    absl::StatusOr<Scan> scan = Read(number);
    if (!scan.ok()) return scan.status();
    return Prepare(number, *std::move(scan), stop);
  }

  absl::StatusOr<Scan> Read(uint64_t number) const { return options_.load_scan(dataset_.scan_paths.at(number)); }

  absl::StatusOr<std::shared_ptr<const PreparedScan>> Prepare(uint64_t number, Scan scan, const Stop& stop) {
    PreparationOptions preparation;
    preparation.limits = options_.tracking.registration.limits;
    absl::StatusOr<std::unique_ptr<const PreparedScan>> prepared = absl::UnknownError("not prepared");
    WithThreadLimit(options_.tracking.registration.num_threads, [&] {
      prepared = PreparedScan::Create(std::make_shared<const Scan>(std::move(scan)), preparation, stop);
    });
    if (!prepared.ok()) return prepared.status();
    kept_.push_front({number, *std::move(prepared)});
    if (kept_.size() > kPreparedScansKept) kept_.pop_back();
    return kept_.front().scan;
  }

 private:
  struct Kept {
    uint64_t number;
    std::shared_ptr<const PreparedScan> scan;
  };
  const Dataset& dataset_;
  const TraverseEvaluationOptions& options_;
  std::list<Kept> kept_;  // most recently used first
};

// The segment with most scans of known truth; where no truth is known, with most scans.
int SegmentToMeasure(const std::vector<TrajectoryPose>& poses, const Dataset& dataset) {
  std::map<int, std::pair<int, int>> scans_of;  // with truth, all
  for (std::size_t i = 0; i < poses.size(); ++i) {
    auto& [with_truth, all] = scans_of[poses[i].segment];
    if (dataset.T_world_scan[i]) ++with_truth;
    ++all;
  }
  return std::max_element(scans_of.begin(), scans_of.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

MeasuredTrajectory Measure(const Traverse& traverse, const Dataset& dataset) {
  MeasuredTrajectory measured;
  measured.poses = traverse.poses;
  std::vector<int> segments;
  for (const TrajectoryPose& pose : traverse.poses) segments.push_back(pose.segment);
  std::sort(segments.begin(), segments.end());
  measured.num_segments = static_cast<int>(std::unique(segments.begin(), segments.end()) - segments.begin());
  const int segment = SegmentToMeasure(traverse.poses, dataset);
  measured.measured_segment = segment;
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i < traverse.poses.size(); ++i) {
    if (traverse.poses[i].segment != segment || !dataset.T_world_scan[i]) continue;
    pairs.push_back({.T_estimate_scan = traverse.poses[i].T_segment_scan, .T_truth_scan = *dataset.T_world_scan[i]});
  }
  measured.num_measured = static_cast<int>(pairs.size());
  const absl::StatusOr<TrajectoryErrors> errors = MeasureTrajectory(pairs);
  if (errors.ok()) measured.errors = *errors;
  return measured;
}

// One pass over the scans for all three maps.
absl::Status MeasureThickness(const Dataset& dataset, const TraverseEvaluationOptions& options,
                              TraverseEvaluation& evaluation) {
  SurfaceThickness tracked, optimised, truth;
  for (std::size_t i = 0; i < dataset.scan_paths.size(); ++i) {
    if (options.tracking.registration.cancellation.stop_requested()) return absl::CancelledError("interrupted");
    const absl::StatusOr<Scan> scan = options.load_scan(dataset.scan_paths[i]);
    if (!scan.ok()) return scan.status();
    const TrajectoryPose& as_tracked = evaluation.tracked.poses[i];
    const TrajectoryPose& as_optimised = evaluation.optimised.poses[i];
    if (as_tracked.segment == evaluation.tracked.measured_segment) tracked.Add(*scan, as_tracked.T_segment_scan);
    if (as_optimised.segment == evaluation.optimised.measured_segment) {
      optimised.Add(*scan, as_optimised.T_segment_scan);
    }
    if (dataset.T_world_scan[i]) truth.Add(*scan, *dataset.T_world_scan[i]);
  }
  evaluation.tracked.thickness = tracked.Measure();
  evaluation.optimised.thickness = optimised.Measure();
  if (evaluation.optimised.errors) evaluation.true_thickness = truth.Measure();
  return absl::OkStatus();
}

void CountLinks(const Dataset& dataset, TraverseEvaluation& evaluation) {
  const SuccessBounds bounds;
  for (const TraverseLink& link : evaluation.links) {
    if (!link.result.verdict.accepted) continue;
    ++evaluation.num_accepted_links;
    const auto& T_world_source = dataset.T_world_scan[link.source];
    const auto& T_world_target = dataset.T_world_scan[link.target];
    if (!T_world_source || !T_world_target) continue;
    const TransformDifference error =
        Difference(T_world_target->inverse() * *T_world_source, *link.result.T_target_source);
    if (error.translation_m >= bounds.translation_m || error.rotation_rad >= bounds.rotation_rad) {
      ++evaluation.num_accepted_wrong_links;
    }
  }
}

// Tracks all scans; after each answer the further links, as a server finds them.
absl::Status Track(const Dataset& dataset, const TraverseEvaluationOptions& options, PreparedShelf& shelf,
                   Traverse& traverse, TraverseEvaluation& evaluation) {
  const Stop stop{options.tracking.registration.cancellation, {}};
  const TraverseScanLoader load = [&](uint64_t number, const Stop& s) { return shelf.Get(number, s); };
  for (std::size_t i = 0; i < dataset.scan_paths.size(); ++i) {
    absl::StatusOr<Scan> scan = shelf.Read(i);
    if (!scan.ok()) return scan.status();
    const Clock::time_point start = Clock::now();
    const absl::StatusOr<std::shared_ptr<const PreparedScan>> prepared = shelf.Prepare(i, *std::move(scan), stop);
    if (!prepared.ok()) return prepared.status();
    const absl::StatusOr<TrackedScan> tracked = TrackScan(
        traverse, {.scan = *prepared, .time_ns = std::nullopt, .prior = std::nullopt}, load, options.tracking, stop);
    if (!tracked.ok()) return tracked.status();
    evaluation.track_seconds.push_back(SecondsSince(start));
    AppendScan(traverse, *tracked, std::nullopt);
    const absl::StatusOr<std::vector<TraverseLink>> links = FindLinks(traverse, i, load, options.tracking, stop);
    if (!links.ok()) return links.status();
    traverse.links.insert(traverse.links.end(), links->begin(), links->end());
    if (options.progress) options.progress(static_cast<int>(i) + 1, dataset.scan_names[i]);
  }
  return absl::OkStatus();
}

absl::Status Optimise(const TraverseEvaluationOptions& options, PreparedShelf& shelf, Traverse& traverse,
                      TraverseEvaluation& evaluation) {
  const Stop stop{options.tracking.registration.cancellation, {}};
  const TraverseScanLoader load = [&](uint64_t number, const Stop& s) { return shelf.Get(number, s); };
  const Clock::time_point start = Clock::now();
  const absl::StatusOr<std::vector<TraverseLink>> links = FindLoopClosures(traverse, load, options.tracking, stop);
  if (!links.ok()) return links.status();
  traverse.links.insert(traverse.links.end(), links->begin(), links->end());
  const absl::StatusOr<TraverseRevision> revision = ReviseTraverse(traverse, options.tracking, stop);
  if (!revision.ok()) return revision.status();
  ApplyRevision(traverse, *revision);
  evaluation.num_given_up_links = revision->num_rejected_links;
  evaluation.converged = revision->converged;
  evaluation.optimise_seconds = SecondsSince(start);
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<TraverseEvaluation> EvaluateTraverse(const Dataset& dataset, const TraverseEvaluationOptions& options) {
  if (dataset.scan_paths.size() < 2) {
    return absl::InvalidArgumentError(dataset.folder + ": a traverse has at least two scans");
  }
  TraverseEvaluation evaluation;
  evaluation.dataset = dataset.folder;
  evaluation.method = options.tracking.registration.method;
  evaluation.num_scans = static_cast<int>(dataset.scan_paths.size());
  PreparedShelf shelf(dataset, options);
  Traverse traverse;
  if (absl::Status status = Track(dataset, options, shelf, traverse, evaluation); !status.ok()) return status;
  evaluation.tracked = Measure(traverse, dataset);
  if (absl::Status status = Optimise(options, shelf, traverse, evaluation); !status.ok()) return status;
  evaluation.optimised = Measure(traverse, dataset);
  evaluation.links = std::move(traverse.links);
  CountLinks(dataset, evaluation);
  if (absl::Status status = MeasureThickness(dataset, options, evaluation); !status.ok()) return status;
  return evaluation;
}

}  // namespace curvereg
