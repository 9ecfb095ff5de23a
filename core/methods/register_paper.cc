// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/methods/register_paper.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>

#include "core/base/parallel.h"
#include "core/methods/stage_timer.h"
#include "core/pose/rigid_fit.h"

namespace curvereg {
namespace {

std::vector<PointPair> PairsOf(const PaperFeatures& source, const PaperFeatures& target,
                               const std::vector<Match>& matches) {
  std::vector<PointPair> pairs;
  pairs.reserve(matches.size());
  for (const Match& match : matches) {
    pairs.push_back(
        {source.points[static_cast<size_t>(match.source)], target.points[static_cast<size_t>(match.target)]});
  }
  return pairs;
}

std::vector<PointPair> Selected(std::span<const PointPair> pairs, std::span<const int> indices) {
  std::vector<PointPair> selected;
  for (const int i : indices) selected.push_back(pairs[static_cast<size_t>(i)]);
  return selected;
}

// Probability that a wrong pair agrees with the transform: the share among the ways to pair the points wrongly, of at
// most about a thousand of the source.
double ChanceOfAgreement(std::span<const PointPair> pairs, const RigidTransform& T_target_source, double threshold_m) {
  const size_t stride = 1 + pairs.size() / 1000;
  int64_t num_agreeing = 1;  // so that no finite sample claims the impossible
  int64_t num_ways = 1;
  for (size_t s = 0; s < pairs.size(); s += stride) {
    const Eigen::Vector3d moved = T_target_source * pairs[s].source;
    for (size_t t = 0; t < pairs.size(); ++t) {
      if (s == t) continue;
      ++num_ways;
      if ((moved - pairs[t].target).squaredNorm() <= threshold_m * threshold_m) ++num_agreeing;
    }
  }
  return static_cast<double>(num_agreeing) / static_cast<double>(num_ways);
}

void Reject(Reason reason, RegistrationResult& result) { result.verdict = {false, {reason}}; }

// Precondition: the consensus has a pose.
void Judge(std::span<const PointPair> pairs, const RansacResult& consensus, const PaperOptions& options,
           RegistrationResult& result) {
  const double chance = ChanceOfAgreement(pairs, *consensus.T_target_source, options.ransac.inlier_threshold_m);
  const int num_pairs = static_cast<int>(pairs.size());
  const int num_inliers = static_cast<int>(consensus.inliers.size());
  result.verdict = {true, {}};
  if (LogFalseAlarms(num_pairs, num_inliers, chance) > std::log(options.max_false_alarms)) {
    Reject(Reason::kNoConsensus, result);
  }
  if (!consensus.is_complete) {
    result.verdict.accepted = false;
    result.verdict.reasons.push_back(Reason::kDeadline);
  }
}

// RANSAC, then SVD of what it kept.
absl::Status EstimatePose(std::span<const PointPair> pairs, const PaperOptions& options, const Stop& stop,
                          RegistrationResult& result) {
  if (pairs.size() < 3) {
    Reject(Reason::kTooFewFeatures, result);
    return absl::OkStatus();
  }
  const absl::StatusOr<RansacResult> consensus = FindRigidConsensus(pairs, options.ransac, stop);
  if (!consensus.ok()) return consensus.status();
  if (!consensus->T_target_source.has_value()) {
    Reject(consensus->is_complete ? Reason::kNoConsensus : Reason::kDeadline, result);
    return absl::OkStatus();
  }
  const absl::StatusOr<RigidTransform> fit = FitRigidTransform(Selected(pairs, consensus->inliers));
  result.T_target_source = fit.ok() ? *fit : *consensus->T_target_source;
  result.evidence.num_inliers = static_cast<int>(consensus->inliers.size());
  result.evidence.num_hypotheses = 1;
  Judge(pairs, *consensus, options, result);
  return absl::OkStatus();
}

// The arguments of RegisterPaper.
struct Call {
  const Scan& source;
  const Scan& target;
  const PaperOptions& options;
  const Stop& stop;
};

absl::StatusOr<std::array<PaperFeatures, 2>> FeaturesOfBoth(const Call& call) {
  std::array<absl::StatusOr<PaperFeatures>, 2> computed;
  ParallelFor(2, [&](int i) {
    const Scan& scan = i == 0 ? call.source : call.target;
    computed[static_cast<size_t>(i)] = ComputePaperFeatures(scan, call.options.features, call.stop);
  });
  std::array<PaperFeatures, 2> both;
  for (size_t i = 0; i < 2; ++i) {
    if (!computed[i].ok()) return computed[i].status();
    both[i] = *std::move(computed[i]);
  }
  return both;
}

// The pipeline. DEADLINE_EXCEEDED when it ends before RANSAC has begun.
absl::Status RunStages(const Call& call, StageTimer& timer, RegistrationResult& result) {
  const absl::StatusOr<std::array<PaperFeatures, 2>> features = FeaturesOfBoth(call);
  if (!features.ok()) return features.status();
  timer.Lap("features");
  const auto& [source, target] = *features;
  result.evidence.num_source_keypoints = static_cast<int>(source.features.size());
  result.evidence.num_target_keypoints = static_cast<int>(target.features.size());
  const absl::StatusOr<std::vector<Match>> matches =
      MatchApproximateMutualNearest(source.features, target.features, call.options.matching, call.stop);
  if (!matches.ok()) return matches.status();
  timer.Lap("matching");
  result.evidence.num_matches = static_cast<int>(matches->size());
  absl::Status status = EstimatePose(PairsOf(source, target, *matches), call.options, call.stop, result);
  timer.Lap("consensus");
  return status;
}

}  // namespace

absl::Status Validate(const PaperOptions& options) {
  if (absl::Status status = Validate(options.features); !status.ok()) return status;
  if (!(options.matching.epsilon >= 0.0 && options.matching.epsilon <= 1e6)) {
    return absl::InvalidArgumentError("paper: epsilon of the matching is not within 0 to 1e6");
  }
  if (!(options.max_false_alarms > 0.0 && options.max_false_alarms < 1.0)) {
    return absl::InvalidArgumentError("paper: the number of false alarms is not between 0 and 1");
  }
  return Validate(options.ransac);
}

absl::StatusOr<RegistrationResult> RegisterPaper(const Scan& source, const Scan& target, const PaperOptions& options,
                                                 const Stop& stop) {
  if (absl::Status status = Validate(options); !status.ok()) return status;
  RegistrationResult result;
  StageTimer timer;
  result.evidence.num_source_points = CountFinitePoints(source);
  result.evidence.num_target_points = CountFinitePoints(target);
  result.evidence.num_attempts = 1;
  absl::Status status = RunStages({source, target, options, stop}, timer, result);
  if (absl::IsDeadlineExceeded(status)) {
    Reject(Reason::kDeadline, result);
  } else if (!status.ok()) {
    return status;
  }
  result.stage_times = timer.Take();
  return result;
}

absl::StatusOr<RegistrationResult> RegisterPaper(const Scan& source, const Scan& target,
                                                 const RegistrationOptions& options, const Stop& stop) {
  PaperOptions paper;
  paper.ransac.seed = options.seed;
  return RegisterPaper(source, target, paper, stop);
}

}  // namespace curvereg
