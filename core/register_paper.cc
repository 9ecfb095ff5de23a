// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/register_paper.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "core/image_conditioning.h"
#include "core/parallel.h"
#include "core/rigid_fit.h"
#include "core/scale_bands.h"
#include "core/stage_timer.h"

namespace curvereg {
namespace {

// Columns by which an image is continued around the circle, so that no key point or descriptor window meets the seam.
constexpr int kWrapPx = 24;

void Normalise(Image<float>& image) {
  const auto [low, high] = std::minmax_element(image.pixels.begin(), image.pixels.end());
  const float offset = *low;
  const float scale = *high > *low ? 1.0F / (*high - *low) : 0.0F;
  for (float& value : image.pixels) value = (value - offset) * scale;
}

Image<float> WrappedAround(const Image<float>& image) {
  Image<float> wrapped(image.rows, image.cols + 2 * kWrapPx);
  for (int row = 0; row < image.rows; ++row) {
    for (int col = 0; col < wrapped.cols; ++col) {
      wrapped(row, col) = image(row, (col - kWrapPx + image.cols) % image.cols);
    }
  }
  return wrapped;
}

// Position of a key point of the wrapped image; nothing when it belongs to a copy, fell on a filled hole or is too
// near.
std::optional<Eigen::Vector3d> PointOf(const Keypoint& keypoint, const RangeImage& image, const Scan& scan,
                                       double min_range_m) {
  const int row = static_cast<int>(std::floor(keypoint.row + 0.5F));
  const int col = static_cast<int>(std::floor(keypoint.col + 0.5F)) - kWrapPx;
  if (!image.range.Contains(row, col) || image.valid(row, col) == 0) return std::nullopt;
  if (image.range(row, col) < min_range_m) return std::nullopt;
  return scan.points[static_cast<size_t>(image.point(row, col))].cast<double>();
}

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

// Probability that a wrong pair agrees with the transform: the share among all ways to pair the points.
double ChanceOfAgreement(std::span<const PointPair> pairs, const RigidTransform& T_target_source, double threshold_m) {
  int64_t num_agreeing = 1;  // so that no finite sample claims the impossible
  for (const PointPair& a : pairs) {
    const Eigen::Vector3d moved = T_target_source * a.source;
    for (const PointPair& b : pairs) {
      if (&a != &b && (moved - b.target).squaredNorm() <= threshold_m * threshold_m) ++num_agreeing;
    }
  }
  const double num_ways = static_cast<double>(pairs.size()) * static_cast<double>(pairs.size());
  return static_cast<double>(num_agreeing) / num_ways;
}

void Reject(Reason reason, RegistrationResult& result) { result.verdict = {false, {reason}}; }

void Judge(std::span<const PointPair> pairs, const RansacResult& consensus, const PaperOptions& options,
           RegistrationResult& result) {
  const double chance = ChanceOfAgreement(pairs, consensus.T_target_source, options.ransac.inlier_threshold_m);
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
  absl::StatusOr<RansacResult> consensus = FindRigidConsensus(pairs, options.ransac, stop);
  if (!consensus.ok()) return consensus.status();
  if (!consensus->has_pose) {
    Reject(consensus->is_complete ? Reason::kNoConsensus : Reason::kDeadline, result);
    return absl::OkStatus();
  }
  const absl::StatusOr<RigidTransform> fit = FitRigidTransform(Selected(pairs, consensus->inliers));
  result.T_target_source = fit.ok() ? *fit : consensus->T_target_source;
  result.has_pose = true;
  result.evidence.num_inliers = static_cast<int>(consensus->inliers.size());
  result.evidence.num_hypotheses = 1;
  Judge(pairs, *consensus, options, result);
  return absl::OkStatus();
}

absl::StatusOr<std::array<PaperFeatures, 2>> FeaturesOfBoth(const Scan& source, const Scan& target,
                                                            const PaperOptions& options) {
  std::array<absl::StatusOr<PaperFeatures>, 2> computed;
  ParallelFor(
      2, [&](int i) { computed[static_cast<size_t>(i)] = ComputePaperFeatures(i == 0 ? source : target, options); });
  std::array<PaperFeatures, 2> both;
  for (size_t i = 0; i < 2; ++i) {
    if (!computed[i].ok()) return computed[i].status();
    both[i] = *std::move(computed[i]);
  }
  return both;
}

}  // namespace

absl::StatusOr<PaperFeatures> ComputePaperFeatures(const Scan& scan, const PaperOptions& options) {
  absl::StatusOr<RangeImage> image = ComputeRangeImage(scan.points, options.image);
  if (!image.ok()) return image.status();
  if (image->range.empty()) return PaperFeatures{};
  Image<float> conditioned = image->range;
  FillHoles(image->valid, conditioned);
  GaussianBlur3x3(options.blur_sigma_px, conditioned);
  Normalise(conditioned);
  absl::StatusOr<std::vector<Image<float>>> bands =
      ComputeScaleBands(conditioned, {.num_scales = options.num_scales, .windows = WindowShape::kCartesian});
  if (!bands.ok()) return bands.status();
  for (Image<float>& band : *bands) band = WrappedAround(band);
  const Image<float> all_valid(bands->front().rows, bands->front().cols, 1.0F);
  std::vector<Keypoint> kept;
  for (const Keypoint& keypoint : DetectKeypoints(DifferenceOfCurvelets(*bands), all_valid, options.keypoints)) {
    if (PointOf(keypoint, *image, scan, options.min_range_m).has_value()) kept.push_back(keypoint);
  }
  PaperFeatures result;
  result.features = DescribeKeypoints(*bands, kept, options.descriptors);
  for (Keypoint& keypoint : result.features.keypoints) {
    result.points.push_back(*PointOf(keypoint, *image, scan, options.min_range_m));
    keypoint.col -= static_cast<float>(kWrapPx);
  }
  return result;
}

absl::StatusOr<RegistrationResult> RegisterPaper(const Scan& source, const Scan& target, const PaperOptions& options,
                                                 const Stop& stop) {
  StageTimer timer;
  RegistrationResult result;
  if (stop.Cancelled()) return absl::CancelledError("registration was cancelled");
  const absl::StatusOr<std::array<PaperFeatures, 2>> features = FeaturesOfBoth(source, target, options);
  if (!features.ok()) return features.status();
  timer.Lap("features");
  const auto& [source_features, target_features] = *features;
  result.evidence.num_source_keypoints = static_cast<int>(source_features.features.size());
  result.evidence.num_target_keypoints = static_cast<int>(target_features.features.size());
  if (stop.Cancelled()) return absl::CancelledError("registration was cancelled");
  const std::vector<Match> matches =
      MatchApproximateMutualNearest(source_features.features, target_features.features, options.matching);
  result.evidence.num_matches = static_cast<int>(matches.size());
  timer.Lap("matching");
  if (matches.size() < 3) {
    Reject(Reason::kTooFewFeatures, result);
  } else if (absl::Status status =
                 EstimatePose(PairsOf(source_features, target_features, matches), options, stop, result);
             !status.ok()) {
    return status;
  }
  timer.Lap("consensus");
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
