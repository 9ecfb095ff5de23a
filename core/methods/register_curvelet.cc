// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/methods/register_curvelet.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/parallel.h"
#include "core/methods/stage_timer.h"
#include "core/methods/verdict.h"
#include "core/pose/pose_hypotheses.h"
#include "core/pose/refinement.h"

namespace curvereg {
namespace {

// SurfaceConsistency above which an accepted pose ends the escalation. A pose that is accepted with less is replaced if
// a further step finds one of higher confidence. Chosen on simulated and real pairs, see docs/method.md.
constexpr double kConfidentConsistency = 0.3;

// A pose under consideration.
struct Candidate {
  RigidTransform T_target_source = RigidTransform::Identity();
  PoseEvidence evidence;
  double score = 0.0;
};

// One step of the escalation: which view, levelled by which vertical of each scan, of the scans as they are or after
// outlier removal.
struct EscalationStep {
  BirdsEyeView view;
  size_t source_vertical;
  size_t target_vertical;
  bool without_outliers;
  int max_hypotheses;
};

// From the cheap common case to what hard scenes need.
std::vector<EscalationStep> EscalationSchedule(const PreparedScan& source, const PreparedScan& target) {
  constexpr int kFew = 8;
  constexpr int kMany = 24;
  std::vector<EscalationStep> steps = {{BirdsEyeView::kElevation, 0, 0, false, kFew},
                                       {BirdsEyeView::kOccupancy, 0, 0, false, kMany}};
  for (size_t s = 0; s < source.verticals().size(); ++s) {
    for (size_t t = 0; t < target.verticals().size(); ++t) {
      if (s + t > 0) steps.push_back({BirdsEyeView::kOccupancy, s, t, false, kMany});
    }
  }
  steps.push_back({BirdsEyeView::kElevation, 0, 0, true, kMany});
  return steps;
}

class CurveletRegistration {
 public:
  CurveletRegistration(const PreparedScan& source, const PreparedScan& target, const RegistrationOptions& options,
                       const Stop& stop)
      : source_(&source), target_(&target), options_(options), stop_(stop) {}

  absl::StatusOr<RegistrationResult> Run() {
    AddGuesses();
    for (const EscalationStep& step : EscalationSchedule(*source_, *target_)) {
      if (stop_.Requested()) break;
      if (step.without_outliers) {
        const absl::Status status = RemoveOutliersOfBoth();
        if (absl::IsInvalidArgument(status)) break;  // too little is left: the answer so far stands
        if (!status.ok()) return status;
        if (stop_.Requested()) break;
      }
      if (absl::Status status = RunStep(step); !status.ok()) return status;
      Decide();
      if (result_.verdict.accepted && is_confident_) break;
    }
    if (stop_.Cancelled()) return absl::CancelledError("registration was cancelled");
    std::vector<Reason>& reasons = result_.verdict.reasons;
    if (!result_.T_target_source.has_value() && stop_.PastDeadline()) reasons.clear();
    const bool is_marked = std::find(reasons.begin(), reasons.end(), Reason::kDeadline) != reasons.end();
    if (!result_.verdict.accepted && !is_marked && stop_.PastDeadline()) reasons.push_back(Reason::kDeadline);
    result_.stage_times = timer_.Take();
    return std::move(result_);
  }

 private:
  // From here on both scans are used without their outliers. The poses found so far were scored on other points and are
  // dropped.
  absl::Status RemoveOutliersOfBoth() {
    std::array<absl::StatusOr<const PreparedScan*>, 2> filtered = {nullptr, nullptr};
    ParallelFor(
        2, [&](int i) { filtered[static_cast<size_t>(i)] = (i == 0 ? source_ : target_)->WithoutOutliers(stop_); });
    for (const auto& scan : filtered) {
      if (!scan.ok() && !stop_.Requested()) return scan.status();
      if (!scan.ok()) return absl::OkStatus();
    }
    source_ = *filtered[0];
    target_ = *filtered[1];
    pool_.clear();
    timer_.Lap("cleaning");
    return absl::OkStatus();
  }

  // Poses to try whatever the features say: the prior, and no motion.
  void AddGuesses() {
    guesses_.emplace_back();
    if (options_.prior.has_value()) {
      guesses_.emplace_back();
      guesses_.back().T_target_source = options_.prior->T_target_source;
    }
  }

  // Key points, matches and hypotheses of one view, refined coarsely and scored into the pool.
  absl::Status RunStep(const EscalationStep& step) {
    std::array<absl::StatusOr<const ViewFeatures*>, 2> views = {nullptr, nullptr};
    ParallelFor(2, [&](int i) {
      views[static_cast<size_t>(i)] = i == 0 ? source_->View(step.view, step.source_vertical, stop_)
                                             : target_->View(step.view, step.target_vertical, stop_);
    });
    for (const auto& view : views) {
      if (!view.ok()) return stop_.Requested() ? absl::OkStatus() : view.status();
    }
    timer_.Lap("features");
    const ViewFeatures& source_view = **views[0];
    const ViewFeatures& target_view = **views[1];
    ConsensusOptions consensus;
    consensus.max_hypotheses = step.max_hypotheses;
    const HypothesesFromViews found = FindPoseHypotheses(source_view, target_view, consensus);
    timer_.Lap("matching");
    AddCandidates(found);
    ScorePool(source_view, target_view);
    timer_.Lap("hypotheses");
    result_.evidence.num_source_keypoints = static_cast<int>(source_view.features.size());
    result_.evidence.num_target_keypoints = static_cast<int>(target_view.features.size());
    ++result_.evidence.num_attempts;
    return absl::OkStatus();
  }

  // Refines the hypotheses, and at first the guesses, coarsely; those that the prior allows join the pool.
  void AddCandidates(const HypothesesFromViews& found) {
    std::vector<Candidate> candidates;
    if (pool_.empty()) candidates = guesses_;
    for (const PoseHypothesis& hypothesis : found.hypotheses) {
      Candidate candidate;
      candidate.T_target_source = hypothesis.T_target_source;
      candidate.evidence.num_inliers = hypothesis.num_inliers;
      candidate.evidence.num_matches = found.num_matches;
      candidates.push_back(candidate);
    }
    ParallelFor(static_cast<int>(candidates.size()),
                [&](int i) { RefineCoarsely(candidates[static_cast<size_t>(i)]); });
    for (Candidate& candidate : candidates) {
      if (AllowedByPrior(candidate.T_target_source)) pool_.push_back(std::move(candidate));
    }
    result_.evidence.num_hypotheses += static_cast<int>(candidates.size());
  }

  // Scores every candidate, earlier ones too, by the best of the views so far: one that shows a pose badly does not
  // count against it. Best first.
  void ScorePool(const ViewFeatures& source_view, const ViewFeatures& target_view) {
    ParallelFor(static_cast<int>(pool_.size()), [&](int i) {
      Candidate& candidate = pool_[static_cast<size_t>(i)];
      const double ncc = CorrelateViews(source_view, target_view, candidate.T_target_source).ncc;
      candidate.evidence.image_correlation = std::max(candidate.evidence.image_correlation, ncc);
      candidate.score = PoseScore(candidate.evidence);
    });
    std::stable_sort(pool_.begin(), pool_.end(),
                     [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  }

  void RefineCoarsely(Candidate& candidate) const {
    RefinementOptions options;
    options.measure_information = false;
    options.converged_m = 0.01;
    options.converged_rad = 0.001;
    const std::vector<VoxelMap>& source_maps = source_->voxel_maps();
    const std::vector<VoxelMap>& target_maps = target_->voxel_maps();
    const size_t coarsest = source_maps.size() - 1;
    for (size_t level = coarsest; level > 0; --level) {
      options.max_iterations = level == coarsest ? 12 : 8;
      candidate.evidence.fit =
          RefineOnLevels(source_maps, target_maps, {level, coarsest}, candidate.T_target_source, options, stop_);
      candidate.T_target_source = candidate.evidence.fit.T_target_source;
    }
    candidate.evidence.check = CheckPose(*source_, *target_, candidate.T_target_source);
  }

  // Within five standard deviations of the prior, where it came with a covariance.
  bool AllowedByPrior(const RigidTransform& T_target_source) const {
    if (!options_.prior.has_value() || !options_.prior->covariance.has_value()) return true;
    const RigidTransform& T_prior = options_.prior->T_target_source;
    Vector6d error;
    const RigidTransform off = T_target_source * T_prior.inverse();  // the left perturbation that the covariance is of
    error << VectorFromRotation(off.linear()), off.translation();
    const double squared = error.dot(options_.prior->covariance->ldlt().solve(error));
    return squared <= 25.0;
  }

  // Refines the best candidates to the end, until one is accepted, and judges that of the highest confidence.
  void Decide() {
    constexpr size_t kMaxFinalists = 3;
    if (pool_.empty() && !result_.T_target_source.has_value()) result_.verdict.reasons = {Reason::kNoConsensus};
    std::vector<Candidate> finalists;
    for (const Candidate& candidate : pool_) {
      const auto is_same = [&](const Candidate& other) { return !IsOtherPose(candidate, other); };
      if (std::any_of(finalists.begin(), finalists.end(), is_same)) continue;
      if (finalists.size() == kMaxFinalists || stop_.Requested()) break;
      finalists.push_back(RefinedToTheEnd(candidate));
      if (Judge(finalists.back(), finalists)) break;
    }
    if (stop_.PastDeadline()) {  // the refinement may have been cut short
      result_.verdict.accepted = false;
      result_.verdict.reasons.push_back(Reason::kDeadline);
    }
    timer_.Lap("verification");
  }

  Candidate RefinedToTheEnd(Candidate candidate) {
    const LevelRange all_levels{0, source_->voxel_maps().size() - 1};
    PoseEvidence& evidence = candidate.evidence;
    evidence.fit = RefineOnLevels(source_->voxel_maps(), target_->voxel_maps(), all_levels, candidate.T_target_source,
                                  RefinementOptions{}, stop_);
    candidate.T_target_source = evidence.fit.T_target_source;
    evidence.check = CheckPose(*source_, *target_, candidate.T_target_source);
    timer_.Lap("refinement");
    return candidate;
  }

  // Writes the finalist to the result when its confidence is the highest so far; true when it is accepted.
  bool Judge(Candidate& finalist, const std::vector<Candidate>& finalists) {
    const double confidence = PoseConfidence(finalist.evidence);
    // A later step of no higher confidence does not replace an earlier one.
    if (confidence <= confidence_) return false;
    confidence_ = confidence;
    // Several hypotheses, or a guess that no match proposed, may have met in this pose: all their matches speak for it.
    for (const Candidate& other : pool_) {
      if (IsOtherPose(finalist, other)) continue;
      finalist.evidence.num_inliers = std::max(finalist.evidence.num_inliers, other.evidence.num_inliers);
      finalist.evidence.num_matches = std::max(finalist.evidence.num_matches, other.evidence.num_matches);
    }
    finalist.evidence.runner_up_ratio = RunnerUpConfidence(finalist, finalists) / confidence;
    FillResult(finalist.T_target_source, finalist.evidence, result_);
    is_confident_ = SurfaceConsistency(finalist.evidence) > kConfidentConsistency;
    return result_.verdict.accepted;
  }

  // The highest confidence of a candidate that is another pose; of those refined to the end, as they ended.
  double RunnerUpConfidence(const Candidate& best, const std::vector<Candidate>& finalists) const {
    double confidence = 0.0;
    for (const Candidate& other : finalists) {
      if (IsOtherPose(best, other)) confidence = std::max(confidence, PoseConfidence(other.evidence));
    }
    for (const Candidate& other : pool_) {
      const auto is_same = [&](const Candidate& finalist) { return !IsOtherPose(other, finalist); };
      if (std::any_of(finalists.begin(), finalists.end(), is_same)) continue;
      confidence = std::max(confidence, PoseConfidence(other.evidence));
    }
    return confidence;
  }

  static bool IsOtherPose(const Candidate& a, const Candidate& b) {
    constexpr double kOtherPoseM = 1.0;
    constexpr double kOtherPoseRad = 0.1;
    const TransformDifference difference = Difference(a.T_target_source, b.T_target_source);
    return difference.translation_m > kOtherPoseM || difference.rotation_rad > kOtherPoseRad;
  }

  const PreparedScan* source_;
  const PreparedScan* target_;
  const RegistrationOptions& options_;
  const Stop& stop_;
  std::vector<Candidate> guesses_;
  std::vector<Candidate> pool_;  // best first
  RegistrationResult result_;
  double confidence_ = -1.0;   // of the pose in result_
  bool is_confident_ = false;  // so consistent that no further step is needed
  StageTimer timer_;
};

}  // namespace

absl::StatusOr<RegistrationResult> RegisterCurvelet(const PreparedScan& source, const PreparedScan& target,
                                                    const RegistrationOptions& options, const Stop& stop) {
  return CurveletRegistration(source, target, options, stop).Run();
}

}  // namespace curvereg
