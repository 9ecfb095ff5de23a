// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// From matches to pose hypotheses. Between two levelled bird's-eye views a pose has a yaw and a shift, so every match
// of oriented features proposes one whole pose by itself, as in [Lowe 2004, section 7.3]; the others vote for it by
// position and orientation. All matches are tried as samples of one (the consensus of [Fischler 1981] without chance).
#ifndef CURVEREG_CORE_POSE_CONSENSUS_H_
#define CURVEREG_CORE_POSE_CONSENSUS_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "core/features/matching.h"
#include "core/features/planar_feature.h"

namespace curvereg {

struct ConsensusOptions {
  double tolerance_m = 0.5;          // tau: position error of a matched key point
  double orientation_rad = 0.35;     // largest disagreement of orientation differences
  double tolerance_per_metre = 0.1;  // a match's own yaw error moves distant points: added per metre of distance
  int max_hypotheses = 8;
  int min_inliers = 3;
  double distinct_m = 1.0;  // hypotheses nearer than this and distinct_rad are one
  double distinct_rad = 0.1;
};

struct PlanarHypothesis {
  double yaw_rad = 0.0;                             // p_target = R(yaw) p_source + shift
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();  // [m]
  std::vector<int> inliers;                         // indices into the matches, ascending
};

// Hypotheses by number of inliers, most first, pairwise distinct. Empty when no pose has min_inliers matches. O(M^2).
std::vector<PlanarHypothesis> FindPlanarHypotheses(const std::vector<PlanarFeature>& source,
                                                   const std::vector<PlanarFeature>& target,
                                                   const std::vector<Match>& matches,
                                                   const ConsensusOptions& options = {});

}  // namespace curvereg

#endif  // CURVEREG_CORE_POSE_CONSENSUS_H_
