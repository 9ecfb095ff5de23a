// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pose/ransac.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace curvereg {
namespace {

constexpr int kSampleSize = 3;
constexpr int kSamplesPerStopCheck = 64;

// SplitMix64: a Weyl sequence through a mixing function.
class Generator {
 public:
  explicit Generator(uint64_t seed) : state_(seed) {}

  // Uniform in [0, n), to 2^-32; n < 2^31.
  int Below(int n) {
    state_ += 0x9e3779b97f4a7c15ULL;
    uint64_t word = state_;
    word = (word ^ (word >> 30)) * 0xbf58476d1ce4e5b9ULL;
    word = (word ^ (word >> 27)) * 0x94d049bb133111ebULL;
    word ^= word >> 31;
    return static_cast<int>(((word >> 32) * static_cast<uint64_t>(n)) >> 32);
  }

 private:
  uint64_t state_;
};

using Sample = std::array<PointPair, kSampleSize>;

Sample DrawSample(std::span<const PointPair> pairs, Generator& generator) {
  const int n = static_cast<int>(pairs.size());
  const int first = generator.Below(n);
  int second = generator.Below(n - 1);
  if (second >= first) ++second;
  int third = generator.Below(n - 2);
  if (third >= std::min(first, second)) ++third;
  if (third >= std::max(first, second)) ++third;
  return {pairs[static_cast<size_t>(first)], pairs[static_cast<size_t>(second)], pairs[static_cast<size_t>(third)]};
}

// By the triangle inequality a transform that agrees with both ends changes no edge by more than two thresholds.
bool EdgesAgree(const Sample& sample, double threshold_m) {
  for (size_t i = 0; i < sample.size(); ++i) {
    const PointPair& a = sample[i];
    const PointPair& b = sample[(i + 1) % sample.size()];
    if (std::abs((a.source - b.source).norm() - (a.target - b.target).norm()) > 2.0 * threshold_m) return false;
  }
  return true;
}

// Empty when the consensus cannot become larger than `size_to_beat`.
std::vector<int> InliersOf(const RigidTransform& T_target_source, std::span<const PointPair> pairs, double threshold_m,
                           size_t size_to_beat) {
  const double squared_threshold = threshold_m * threshold_m;
  std::vector<int> inliers;
  for (size_t i = 0; i < pairs.size(); ++i) {
    if (inliers.size() + (pairs.size() - i) <= size_to_beat) return {};
    const double squared = (T_target_source * pairs[i].source - pairs[i].target).squaredNorm();
    if (squared <= squared_threshold) inliers.push_back(static_cast<int>(i));
  }
  return inliers.size() > size_to_beat ? inliers : std::vector<int>();
}

// Samples after which one of only right pairs has been drawn with the wanted probability.
double IterationsNeeded(size_t num_inliers, size_t num_pairs, double confidence) {
  const double share = static_cast<double>(num_inliers) / static_cast<double>(num_pairs);
  const double all_right = share * share * share;
  if (all_right >= 1.0) return 1.0;
  return std::log1p(-confidence) / std::log1p(-all_right);
}

bool AllFinite(std::span<const PointPair> pairs) {
  return std::ranges::all_of(pairs,
                             [](const PointPair& pair) { return pair.source.allFinite() && pair.target.allFinite(); });
}

// Natural logarithm of C(n, k). Not by std::lgamma, which writes a global variable.
double LogBinomial(int n, int k) {
  double sum = 0.0;
  for (int i = 1; i <= k; ++i) sum += std::log(static_cast<double>(n - k + i) / i);
  return sum;
}

}  // namespace

absl::Status Validate(const RansacOptions& options) {
  if (!(options.inlier_threshold_m > 0.0) || !std::isfinite(options.inlier_threshold_m)) {
    return absl::InvalidArgumentError("RANSAC: the inlier threshold is not a length above 0");
  }
  if (options.max_iterations < 1) return absl::InvalidArgumentError("RANSAC: fewer than one iteration");
  if (!(options.confidence > 0.0 && options.confidence < 1.0)) {
    return absl::InvalidArgumentError("RANSAC: the confidence is not between 0 and 1");
  }
  return absl::OkStatus();
}

absl::StatusOr<RansacResult> FindRigidConsensus(std::span<const PointPair> pairs, const RansacOptions& options,
                                                const Stop& stop) {
  if (absl::Status status = Validate(options); !status.ok()) return status;
  if (!AllFinite(pairs)) return absl::InvalidArgumentError("RANSAC: a coordinate is not finite");
  RansacResult result;
  Generator generator(options.seed);
  double num_needed = pairs.size() < kSampleSize ? 0.0 : static_cast<double>(options.max_iterations);
  while (result.num_iterations < num_needed) {
    if (result.num_iterations % kSamplesPerStopCheck == 0) {
      if (stop.Cancelled()) return absl::CancelledError("RANSAC was cancelled");
      if (stop.PastDeadline()) return result;
    }
    ++result.num_iterations;
    const Sample sample = DrawSample(pairs, generator);
    if (!EdgesAgree(sample, options.inlier_threshold_m)) continue;
    const absl::StatusOr<RigidTransform> T_target_source = FitRigidTransform(sample);
    if (!T_target_source.ok()) continue;  // three points on a line
    const size_t size_to_beat = std::max(result.inliers.size(), size_t{kSampleSize - 1});
    std::vector<int> inliers = InliersOf(*T_target_source, pairs, options.inlier_threshold_m, size_to_beat);
    if (inliers.empty()) continue;
    num_needed = std::min(num_needed, IterationsNeeded(inliers.size(), pairs.size(), options.confidence));
    result.T_target_source = *T_target_source;
    result.inliers = std::move(inliers);
  }
  result.is_complete = true;
  return result;
}

double LogFalseAlarms(int num_pairs, int num_inliers, double chance) {
  if (num_inliers <= kSampleSize) return std::numeric_limits<double>::infinity();
  const int num_confirming = num_inliers - kSampleSize;
  return std::log(static_cast<double>(num_pairs - kSampleSize)) + LogBinomial(num_pairs, num_inliers) +
         LogBinomial(num_inliers, kSampleSize) + num_confirming * std::log(chance);
}

}  // namespace curvereg
