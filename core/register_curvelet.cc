// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/register_curvelet.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "core/pose_hypotheses.h"
#include "core/refinement.h"
#include "core/stage_timer.h"
#include "core/verdict.h"

namespace curvereg {
namespace {

// A pose under consideration.
struct Candidate {
  RigidTransform T_target_source = RigidTransform::Identity();
  PoseEvidence evidence;
  double score = 0.0;
};

// One rung of the ladder: which view, levelled by which vertical of each scan, of the scans as they are or cleaned.
struct Rung {
  BirdsEyeView view;
  size_t source_vertical;
  size_t target_vertical;
  bool cleaned;
  int max_hypotheses;
};

// From the cheap common case to what hard scenes need.
std::vector<Rung> Ladder(const PreparedScan& source, const PreparedScan& target) {
  constexpr int kFew = 8;
  constexpr int kMany = 24;
  std::vector<Rung> rungs = {{BirdsEyeView::kElevation, 0, 0, false, kFew},
                             {BirdsEyeView::kOccupancy, 0, 0, false, kMany}};
  for (size_t s = 0; s < source.verticals().size(); ++s) {
    for (size_t t = 0; t < target.verticals().size(); ++t) {
      if (s + t > 0) rungs.push_back({BirdsEyeView::kOccupancy, s, t, false, kMany});
    }
  }
  rungs.push_back({BirdsEyeView::kElevation, 0, 0, true, kMany});
  return rungs;
}

class CurveletRegistration {
 public:
  CurveletRegistration(const PreparedScan& source, const PreparedScan& target, const RegistrationOptions& options,
                       const Stop& stop)
      : source_(source), target_(target), options_(options), stop_(stop) {}

  absl::StatusOr<RegistrationResult> Run() {
    AddGuesses();
    bool cleaned = false;
    for (const Rung& rung : Ladder(source_, target_)) {
      if (stop_.Requested()) break;
      if (rung.cleaned && !cleaned) pool_.clear();  // judged on other points: not comparable
      cleaned = rung.cleaned;
      if (absl::Status status = Climb(rung); !status.ok()) return status;
      Decide(rung);
      if (result_.verdict.accepted) break;
    }
    if (stop_.Cancelled()) return absl::CancelledError("registration was cancelled");
    if (stop_.PastDeadline() && !result_.verdict.accepted) result_.verdict.reasons.push_back(Reason::kDeadline);
    result_.stage_times = timer_.Take();
    return std::move(result_);
  }

 private:
  const PreparedScan& Source(const Rung& rung) const { return rung.cleaned ? source_.Cleaned() : source_; }
  const PreparedScan& Target(const Rung& rung) const { return rung.cleaned ? target_.Cleaned() : target_; }

  // Poses to try whatever the features say: the prior, and no motion.
  void AddGuesses() {
    guesses_.emplace_back();
    if (options_.prior.has_value()) {
      guesses_.emplace_back();
      guesses_.back().T_target_source = options_.prior->T_target_source;
    }
  }

  // Key points, matches and hypotheses of one view, refined coarsely and scored into the pool.
  absl::Status Climb(const Rung& rung) {
    std::array<absl::StatusOr<const ViewFeatures*>, 2> views = {nullptr, nullptr};
    ParallelFor(2, [&](int i) {
      views[static_cast<size_t>(i)] = i == 0 ? Source(rung).View(rung.view, rung.source_vertical)
                                             : Target(rung).View(rung.view, rung.target_vertical);
    });
    for (const auto& view : views) {
      if (!view.ok()) return view.status();
    }
    timer_.Lap("features");
    ConsensusOptions consensus;
    consensus.max_hypotheses = rung.max_hypotheses;
    const HypothesesFromViews found = FindPoseHypotheses(**views[0], **views[1], consensus);
    timer_.Lap("matching");
    std::vector<Candidate> candidates;
    if (pool_.empty()) candidates = guesses_;
    for (const PoseHypothesis& hypothesis : found.hypotheses) {
      Candidate candidate;
      candidate.T_target_source = hypothesis.T_target_source;
      candidate.evidence.num_inliers = hypothesis.num_inliers;
      candidate.evidence.num_matches = found.num_matches;
      candidates.push_back(candidate);
    }
    ParallelFor(static_cast<int>(candidates.size()), [&](int i) {
      Candidate& candidate = candidates[static_cast<size_t>(i)];
      RefineCoarsely(rung, candidate);
      candidate.evidence.image_correlation = CorrelateViews(**views[0], **views[1], candidate.T_target_source).ncc;
      candidate.score = PoseScore(candidate.evidence);
    });
    for (Candidate& candidate : candidates) {
      if (AllowedByPrior(candidate.T_target_source)) pool_.push_back(std::move(candidate));
    }
    std::stable_sort(pool_.begin(), pool_.end(), [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
    timer_.Lap("hypotheses");
    Evidence& evidence = result_.evidence;
    evidence.num_source_keypoints = static_cast<int>((*views[0])->features.size());
    evidence.num_target_keypoints = static_cast<int>((*views[1])->features.size());
    evidence.num_matches = found.num_matches;
    evidence.num_hypotheses += static_cast<int>(candidates.size());
    ++evidence.num_attempts;
    return absl::OkStatus();
  }

  void RefineCoarsely(const Rung& rung, Candidate& candidate) const {
    RefinementOptions options;
    options.converged_m = 0.01;
    options.converged_rad = 0.001;
    const auto& source_maps = Source(rung).voxel_maps();
    const auto& target_maps = Target(rung).voxel_maps();
    const size_t coarsest = source_maps.size() - 1;
    for (size_t level = coarsest; level > 0; --level) {
      options.max_iterations = level == coarsest ? 12 : 8;
      candidate.evidence.fit = RefineOnLevels(source_maps, target_maps, {level, coarsest}, candidate.T_target_source,
                                              options, stop_);
      candidate.T_target_source = candidate.evidence.fit.T_target_source;
    }
    candidate.evidence.check = CheckPose(Source(rung), Target(rung), candidate.T_target_source);
  }

  // Within five standard deviations of the prior, where it came with a covariance.
  bool AllowedByPrior(const RigidTransform& T_target_source) const {
    if (!options_.prior.has_value() || !options_.prior->covariance.has_value()) return true;
    const RigidTransform& T_prior = options_.prior->T_target_source;
    Vector6d error;
    error << VectorFromRotation(T_target_source.linear() * T_prior.linear().transpose()),
        T_target_source.translation() - T_prior.translation();
    const double squared = error.dot(options_.prior->covariance->ldlt().solve(error));
    return squared <= 25.0;
  }

  // Refines the best candidate to the end and judges it.
  void Decide(const Rung& rung) {
    if (pool_.empty()) {
      result_.verdict.reasons = {Reason::kNoConsensus};
      return;
    }
    const PreparedScan& source = Source(rung);
    const PreparedScan& target = Target(rung);
    Candidate best = pool_.front();
    best.evidence.fit = RefineOnLevels(source.voxel_maps(), target.voxel_maps(), {0, source.voxel_maps().size() - 1},
                                       best.T_target_source, RefinementOptions{}, stop_);
    best.T_target_source = best.evidence.fit.T_target_source;
    timer_.Lap("refinement");
    best.evidence.check = CheckPose(source, target, best.T_target_source);
    best.evidence.runner_up_ratio = RunnerUpRatio(best.T_target_source);
    FillResult(best);
    timer_.Lap("verification");
  }

  // Score of the best candidate that is another pose, over the best of all.
  double RunnerUpRatio(const RigidTransform& T_best) const {
    constexpr double kOtherPoseM = 1.0;
    constexpr double kOtherPoseRad = 0.1;
    for (const Candidate& candidate : pool_) {
      const TransformDifference difference = Difference(T_best, candidate.T_target_source);
      if (difference.translation_m > kOtherPoseM || difference.rotation_rad > kOtherPoseRad) {
        return pool_.front().score > 0.0 ? candidate.score / pool_.front().score : 1.0;
      }
    }
    return 0.0;
  }

  void FillResult(const Candidate& best) {
    const VerdictOptions verdict_options;
    result_.T_target_source = best.T_target_source;
    result_.has_pose = true;
    result_.degenerate_directions = FindDegenerateDirections(best.evidence.fit, verdict_options.min_information_z);
    result_.verdict = DecideVerdict(best.evidence, result_.degenerate_directions, verdict_options);
    result_.covariance = PoseCovariance(best.evidence.fit);
    result_.has_covariance = best.evidence.fit.num_pairs >= 6;
    Evidence& evidence = result_.evidence;
    evidence.num_inliers = best.evidence.num_inliers;
    evidence.num_matches = best.evidence.num_matches;
    evidence.overlap_source = best.evidence.check.overlap_source;
    evidence.overlap_target = best.evidence.check.overlap_target;
    evidence.free_space_agreement = best.evidence.check.free_space_agreement;
    evidence.image_correlation = best.evidence.image_correlation;
    evidence.inlier_fraction = best.evidence.fit.inlier_fraction;
    evidence.residual_rmse_m = best.evidence.fit.residual_rms_m;
    evidence.residual_median_m = best.evidence.fit.residual_median_m;
    evidence.residual_p90_m = best.evidence.fit.residual_p90_m;
    evidence.runner_up_ratio = best.evidence.runner_up_ratio;
  }

  const PreparedScan& source_;
  const PreparedScan& target_;
  const RegistrationOptions& options_;
  const Stop& stop_;
  std::vector<Candidate> guesses_;
  std::vector<Candidate> pool_;  // best first
  RegistrationResult result_;
  StageTimer timer_;
};

}  // namespace

absl::StatusOr<RegistrationResult> RegisterCurvelet(const PreparedScan& source, const PreparedScan& target,
                                                    const RegistrationOptions& options, const Stop& stop) {
  return CurveletRegistration(source, target, options, stop).Run();
}

}  // namespace curvereg
