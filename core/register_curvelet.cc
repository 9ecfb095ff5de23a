// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/register_curvelet.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "core/parallel.h"
#include "core/pose_hypotheses.h"
#include "core/refinement.h"
#include "core/verdict.h"

namespace curvereg {
namespace {

struct Candidate {
  RigidTransform T_target_source = RigidTransform::Identity();
  int num_inliers = 0;
  int rung = 0;
  SurfaceFit fit;
  PoseCheck check;
  double score = 0.0;
};

// One rung of the ladder: a kind of view and which vertical of each scan levels it.
struct Rung {
  BirdsEyeView view;
  size_t source_vertical;
  size_t target_vertical;
};

std::vector<Rung> Ladder(const PreparedScan& source, const PreparedScan& target) {
  std::vector<Rung> rungs = {{BirdsEyeView::kElevation, 0, 0}, {BirdsEyeView::kOccupancy, 0, 0}};
  for (size_t s = 0; s < source.verticals().size(); ++s) {
    for (size_t t = 0; t < target.verticals().size(); ++t) {
      if (s + t > 0) rungs.push_back({BirdsEyeView::kOccupancy, s, t});
    }
  }
  return rungs;
}

void RefineCoarse(const PreparedScan& source, const PreparedScan& target, const Stop& stop, Candidate& candidate) {
  RefinementOptions options;
  for (size_t level = 3; level-- > 1;) {
    options.max_iterations = level == 2 ? 12 : 8;
    options.converged_m = 0.01;
    options.converged_rad = 0.001;
    candidate.fit = RefineOnLevel(source.voxel_maps()[level], target.voxel_maps()[level], candidate.T_target_source,
                                  options, stop);
    candidate.T_target_source = candidate.fit.T_target_source;
  }
  candidate.check = CheckPose(source, target, candidate.T_target_source);
  const double fs = candidate.check.free_space_agreement;
  candidate.score = fs * fs * fs * std::min(candidate.check.overlap_source, candidate.check.overlap_target) *
                    candidate.fit.inlier_fraction / (candidate.fit.residual_rms_m + 0.02);
}

}  // namespace

absl::StatusOr<RegistrationResult> RegisterCurvelet(const PreparedScan& source, const PreparedScan& target,
                                                    const RegistrationOptions& options) {
  RegistrationResult result;
  const Stop stop{options.cancellation, std::nullopt};
  const bool debug = std::getenv("CRDEBUG") != nullptr;
  const int max_rungs = std::getenv("CRRUNGS") ? atoi(std::getenv("CRRUNGS")) : 9;
  const int only = std::getenv("CRONLY") ? atoi(std::getenv("CRONLY")) : -1;
  std::vector<Candidate> pool;
  int rung_index = 0;
  for (const Rung& rung : Ladder(source, target)) {
    if (rung_index >= max_rungs) break;
    if (only >= 0 && rung_index != only) { ++rung_index; continue; }
    const ViewFeatures* views[2] = {nullptr, nullptr};
    absl::Status statuses[2];
    ParallelFor(2, [&](int i) {
      auto view = i == 0 ? source.View(rung.view, rung.source_vertical) : target.View(rung.view, rung.target_vertical);
      if (view.ok()) views[i] = *view; else statuses[i] = view.status();
    });
    for (const absl::Status& status : statuses) if (!status.ok()) return status;
    ConsensusOptions consensus;
    consensus.max_hypotheses = rung.view == BirdsEyeView::kElevation ? 8 : 24;
    const HypothesesFromViews found = FindPoseHypotheses(*views[0], *views[1], consensus);
    std::vector<Candidate> candidates;
    for (const PoseHypothesis& h : found.hypotheses) {
      Candidate c;
      c.T_target_source = h.T_target_source;
      c.num_inliers = h.num_inliers;
      c.rung = rung_index;
      candidates.push_back(c);
    }
    if (rung_index == 0) candidates.emplace_back();
    if (debug) {
      std::printf("rung %d: kp %zu %zu matches %d hyp %zu inl", rung_index, views[0]->features.size(), views[1]->features.size(), found.num_matches, found.hypotheses.size());
      for (const auto& h : found.hypotheses) std::printf(" %d", h.num_inliers);
      std::printf("\n");
    }
    ParallelFor(static_cast<int>(candidates.size()), [&](int i) { RefineCoarse(source, target, stop, candidates[static_cast<size_t>(i)]); });
    pool.insert(pool.end(), candidates.begin(), candidates.end());
    result.evidence.num_matches += found.num_matches;
    ++rung_index;
  }
  std::stable_sort(pool.begin(), pool.end(), [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  if (pool.empty()) return result;
  Candidate best = pool.front();
  RefinementOptions refinement;
  best.fit = RefineOnLevel(source.voxel_maps()[0], target.voxel_maps()[0], best.T_target_source, refinement, stop);
  best.T_target_source = best.fit.T_target_source;
  best.check = CheckPose(source, target, best.T_target_source);
  auto views = std::pair(source.View(BirdsEyeView::kElevation, 0), target.View(BirdsEyeView::kElevation, 0));
  const ViewCorrelation corr = CorrelateViews(**views.first, **views.second, best.T_target_source);
  auto oviews = std::pair(source.View(BirdsEyeView::kOccupancy, 0), target.View(BirdsEyeView::kOccupancy, 0));
  const ViewCorrelation ocorr = CorrelateViews(**oviews.first, **oviews.second, best.T_target_source);
  if (debug) {
    for (const Candidate& c : pool) std::printf("  rung %d inl %d score %.3f fs %.3f ov %.2f %.2f inlf %.2f rms %.4f t %.2f %.2f %.2f rot %.3f\n", c.rung, c.num_inliers, c.score, c.check.free_space_agreement, c.check.overlap_source, c.check.overlap_target, c.fit.inlier_fraction, c.fit.residual_rms_m, c.T_target_source.translation().x(), c.T_target_source.translation().y(), c.T_target_source.translation().z(), RotationAngle(c.T_target_source));
  }
  result.has_pose = true;
  result.T_target_source = best.T_target_source;
  result.evidence.num_inliers = best.num_inliers;
  result.evidence.num_attempts = best.rung;
  result.evidence.free_space_agreement = best.check.free_space_agreement;
  result.evidence.overlap_source = best.check.overlap_source;
  result.evidence.overlap_target = best.check.overlap_target;
  result.evidence.image_correlation = corr.ncc;
  result.evidence.residual_p90_m = ocorr.ncc;
  result.evidence.inlier_fraction = best.fit.inlier_fraction;
  result.evidence.residual_rmse_m = best.fit.residual_rms_m;
  double runner = 0;
  for (const Candidate& c : pool) {
    auto d = Difference(c.T_target_source, best.T_target_source);
    if (d.rotation_rad > 0.1 || d.translation_m > 1.0) { runner = std::max(runner, c.score / pool.front().score); }
  }
  result.evidence.runner_up_ratio = runner;
  return result;
}

}  // namespace curvereg
