// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pose/consensus.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/base/parallel.h"
#include "core/base/simd.h"

namespace curvereg {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

float WrappedAngle(float angle) {
  if (angle >= kPi) return angle - 2.0F * kPi;
  if (angle < -kPi) return angle + 2.0F * kPi;
  return angle;
}

// Matched positions and orientation differences, one array per coordinate so that voting vectorises.
struct MatchArrays {
  std::vector<float> sx, sy, tx, ty, yaw;
};

MatchArrays GatherMatches(const std::vector<PlanarFeature>& source, const std::vector<PlanarFeature>& target,
                          const std::vector<Match>& matches) {
  MatchArrays arrays;
  for (const Match& match : matches) {
    const PlanarFeature& s = source[static_cast<size_t>(match.source)];
    const PlanarFeature& t = target[static_cast<size_t>(match.target)];
    arrays.sx.push_back(static_cast<float>(s.position.x()));
    arrays.sy.push_back(static_cast<float>(s.position.y()));
    arrays.tx.push_back(static_cast<float>(t.position.x()));
    arrays.ty.push_back(static_cast<float>(t.position.y()));
    arrays.yaw.push_back(WrappedAngle(static_cast<float>(t.orientation_rad - s.orientation_rad)));
  }
  return arrays;
}

struct VoteTolerances {
  float position, position_per_metre, orientation;
};

// Number of matches that agree with the pose proposed by match `i` alone.
CURVEREG_DISPATCH int CountVotes(const float* sx, const float* sy, const float* tx, const float* ty, const float* yaw,
                                 int num_matches, int i, VoteTolerances tolerances) {
  const float cosine = std::cos(yaw[i]);
  const float sine = std::sin(yaw[i]);
  const float sx0 = sx[i], sy0 = sy[i], tx0 = tx[i], ty0 = ty[i], yaw0 = yaw[i];
  int votes = 0;
  for (int j = 0; j < num_matches; ++j) {
    const float dx = sx[j] - sx0;
    const float dy = sy[j] - sy0;
    const float ex = cosine * dx - sine * dy - (tx[j] - tx0);
    const float ey = sine * dx + cosine * dy - (ty[j] - ty0);
    const float limit = tolerances.position + tolerances.position_per_metre * std::sqrt(dx * dx + dy * dy);
    const float turn = std::abs(yaw[j] - yaw0);
    const float difference = std::min(turn, 2.0F * kPi - turn);
    votes +=
        static_cast<int>(ex * ex + ey * ey < limit * limit) & static_cast<int>(difference < tolerances.orientation);
  }
  return votes;
}

// Least-squares planar motion of the chosen matches (closed form).
void FitPlanarMotion(const MatchArrays& m, PlanarHypothesis& hypothesis) {
  double n = 0.0, sx = 0.0, sy = 0.0, tx = 0.0, ty = 0.0;
  for (const int index : hypothesis.inliers) {
    const auto i = static_cast<size_t>(index);
    n += 1.0;
    sx += m.sx[i];
    sy += m.sy[i];
    tx += m.tx[i];
    ty += m.ty[i];
  }
  const Eigen::Vector2d mean_source(sx / n, sy / n);
  const Eigen::Vector2d mean_target(tx / n, ty / n);
  double dot = 0.0, cross = 0.0;
  for (const int index : hypothesis.inliers) {
    const auto i = static_cast<size_t>(index);
    const Eigen::Vector2d s = Eigen::Vector2d(m.sx[i], m.sy[i]) - mean_source;
    const Eigen::Vector2d t = Eigen::Vector2d(m.tx[i], m.ty[i]) - mean_target;
    dot += s.dot(t);
    cross += s.x() * t.y() - s.y() * t.x();
  }
  if (dot != 0.0 || cross != 0.0) hypothesis.yaw_rad = std::atan2(cross, dot);
  hypothesis.shift = mean_target - Eigen::Rotation2Dd(hypothesis.yaw_rad) * mean_source;
}

// Matches within `limit_m` of the pose and with agreeing orientation.
void SelectInliers(const MatchArrays& m, double limit_m, double orientation_rad, PlanarHypothesis& hypothesis) {
  const double cosine = std::cos(hypothesis.yaw_rad);
  const double sine = std::sin(hypothesis.yaw_rad);
  hypothesis.inliers.clear();
  for (size_t i = 0; i < m.sx.size(); ++i) {
    const double ex = cosine * m.sx[i] - sine * m.sy[i] + hypothesis.shift.x() - m.tx[i];
    const double ey = sine * m.sx[i] + cosine * m.sy[i] + hypothesis.shift.y() - m.ty[i];
    const double turn = std::remainder(m.yaw[i] - hypothesis.yaw_rad, 2.0 * std::numbers::pi);
    if (ex * ex + ey * ey < limit_m * limit_m && std::abs(turn) < orientation_rad) {
      hypothesis.inliers.push_back(static_cast<int>(i));
    }
  }
}

// The pose that match `seed` proposes, refitted to all that agree, at a shrinking tolerance.
PlanarHypothesis RefinedHypothesis(const MatchArrays& m, int seed, const ConsensusOptions& options) {
  const auto i = static_cast<size_t>(seed);
  PlanarHypothesis hypothesis;
  hypothesis.yaw_rad = m.yaw[i];
  hypothesis.shift =
      Eigen::Vector2d(m.tx[i], m.ty[i]) - Eigen::Rotation2Dd(hypothesis.yaw_rad) * Eigen::Vector2d(m.sx[i], m.sy[i]);
  // The first selection allows for the match's own yaw error, as the vote does.
  const float cosine = std::cos(m.yaw[i]);
  const float sine = std::sin(m.yaw[i]);
  for (size_t j = 0; j < m.sx.size(); ++j) {
    const float dx = m.sx[j] - m.sx[i], dy = m.sy[j] - m.sy[i];
    const float ex = cosine * dx - sine * dy - (m.tx[j] - m.tx[i]);
    const float ey = sine * dx + cosine * dy - (m.ty[j] - m.ty[i]);
    const float limit = 2.0F * static_cast<float>(options.tolerance_m) +
                        static_cast<float>(options.tolerance_per_metre) * std::sqrt(dx * dx + dy * dy);
    const double turn = std::remainder(m.yaw[j] - m.yaw[i], 2.0F * kPi);
    if (ex * ex + ey * ey < limit * limit && std::abs(turn) < options.orientation_rad) {
      hypothesis.inliers.push_back(static_cast<int>(j));
    }
  }
  for (const double factor : {2.0, 1.5, 1.0, 1.0}) {
    if (hypothesis.inliers.size() < 2) break;
    FitPlanarMotion(m, hypothesis);
    SelectInliers(m, factor * options.tolerance_m, options.orientation_rad, hypothesis);
  }
  return hypothesis;
}

bool SamePose(const PlanarHypothesis& a, const PlanarHypothesis& b, const ConsensusOptions& options) {
  const double turn = std::abs(std::remainder(a.yaw_rad - b.yaw_rad, 2.0 * std::numbers::pi));
  return turn < options.distinct_rad && (a.shift - b.shift).norm() < options.distinct_m;
}

// Matches that agree with the pose that each match proposes.
std::vector<int> VotesOf(const MatchArrays& arrays, int num_matches, const ConsensusOptions& options) {
  const VoteTolerances tolerances{2.0F * static_cast<float>(options.tolerance_m),
                                  static_cast<float>(options.tolerance_per_metre),
                                  static_cast<float>(options.orientation_rad)};
  std::vector<int> votes(static_cast<size_t>(num_matches));
  constexpr int kBlock = 64;
  ParallelFor((num_matches + kBlock - 1) / kBlock, [&](int block) {
    for (int i = block * kBlock; i < std::min(num_matches, (block + 1) * kBlock); ++i) {
      votes[static_cast<size_t>(i)] = CountVotes(arrays.sx.data(), arrays.sy.data(), arrays.tx.data(), arrays.ty.data(),
                                                 arrays.yaw.data(), num_matches, i, tolerances);
    }
  });
  return votes;
}

}  // namespace

std::vector<PlanarHypothesis> FindPlanarHypotheses(const std::vector<PlanarFeature>& source,
                                                   const std::vector<PlanarFeature>& target,
                                                   const std::vector<Match>& matches, const ConsensusOptions& options) {
  const MatchArrays arrays = GatherMatches(source, target, matches);
  const std::vector<int> votes = VotesOf(arrays, static_cast<int>(matches.size()), options);
  std::vector<int> order(matches.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return votes[static_cast<size_t>(a)] > votes[static_cast<size_t>(b)]; });
  // More seeds than hypotheses, as many seeds lead to one pose.
  const auto max_seeds = static_cast<size_t>(8 * options.max_hypotheses);
  std::vector<PlanarHypothesis> found;
  for (size_t k = 0; k < std::min(order.size(), max_seeds); ++k) {
    const int seed = order[k];
    if (votes[static_cast<size_t>(seed)] < options.min_inliers) break;
    const bool explained = std::any_of(found.begin(), found.end(), [&](const PlanarHypothesis& known) {
      return std::binary_search(known.inliers.begin(), known.inliers.end(), seed);
    });
    if (explained) continue;
    PlanarHypothesis hypothesis = RefinedHypothesis(arrays, seed, options);
    if (static_cast<int>(hypothesis.inliers.size()) < options.min_inliers) continue;
    const bool known = std::any_of(found.begin(), found.end(),
                                   [&](const PlanarHypothesis& other) { return SamePose(other, hypothesis, options); });
    if (!known) found.push_back(std::move(hypothesis));
  }
  std::stable_sort(found.begin(), found.end(), [](const PlanarHypothesis& a, const PlanarHypothesis& b) {
    return a.inliers.size() > b.inliers.size();
  });
  if (found.size() > static_cast<size_t>(options.max_hypotheses))
    found.resize(static_cast<size_t>(options.max_hypotheses));
  return found;
}

}  // namespace curvereg
