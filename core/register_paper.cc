// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/register_paper.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>

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

// Index of the return under a key point of the wrapped image; -1 when the key point belongs to a copy, lies on a filled
// hole or is too near.
int32_t ReturnOf(const Keypoint& keypoint, const RangeImage& image, double min_range_m) {
  const int row = static_cast<int>(std::floor(keypoint.row + 0.5F));
  const int col = static_cast<int>(std::floor(keypoint.col + 0.5F)) - kWrapPx;
  if (!image.range.Contains(row, col) || image.valid(row, col) == 0) return -1;
  return image.range(row, col) < min_range_m ? -1 : image.point(row, col);
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

// The scan's image on [0, 1], without holes. Precondition: it has returns.
Image<float> Conditioned(const RangeImage& image, double blur_sigma_px) {
  Image<float> conditioned = image.range;
  FillHoles(image.valid, conditioned);
  GaussianBlur3x3(blur_sigma_px, conditioned);
  Normalise(conditioned);
  return conditioned;
}

// Key points with a return of their own, of the images that WrappedAround continued.
std::vector<Keypoint> DetectOnReturns(const std::vector<Image<float>>& bands, const RangeImage& image,
                                      const PaperOptions& options) {
  const Image<float> all_valid(bands.front().rows, bands.front().cols, 1.0F);
  std::vector<Keypoint> keypoints = DetectKeypoints(DifferenceOfCurvelets(bands), all_valid, options.keypoints);
  std::erase_if(keypoints,
                [&](const Keypoint& keypoint) { return ReturnOf(keypoint, image, options.min_range_m) < 0; });
  return keypoints;
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
  if (pairs.size() < 3) {
    Reject(Reason::kTooFewFeatures, result);
    return absl::OkStatus();
  }
  const absl::StatusOr<RansacResult> consensus = FindRigidConsensus(pairs, options.ransac, stop);
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

absl::Status AskStop(const Stop& stop) {
  if (stop.Cancelled()) return absl::CancelledError("registration was cancelled");
  if (stop.PastDeadline()) return absl::DeadlineExceededError("registration ran out of time");
  return absl::OkStatus();
}

absl::StatusOr<std::array<PaperFeatures, 2>> FeaturesOfBoth(const Scan& source, const Scan& target,
                                                            const PaperOptions& options, const Stop& stop) {
  std::array<absl::StatusOr<PaperFeatures>, 2> computed;
  ParallelFor(2, [&](int i) {
    computed[static_cast<size_t>(i)] = ComputePaperFeatures(i == 0 ? source : target, options, stop);
  });
  std::array<PaperFeatures, 2> both;
  for (size_t i = 0; i < 2; ++i) {
    if (!computed[i].ok()) return computed[i].status();
    both[i] = *std::move(computed[i]);
  }
  return both;
}

}  // namespace

absl::Status Validate(const PaperOptions& options) {
  if (!(options.blur_sigma_px >= 0.0 && options.blur_sigma_px <= 10.0)) {
    return absl::InvalidArgumentError("paper: the blur is not within 0 to 10 pixels");
  }
  if (!(options.min_range_m >= 0.0) || !std::isfinite(options.min_range_m)) {
    return absl::InvalidArgumentError("paper: the least range of key points is not a length of at least 0");
  }
  if (!(options.matching.epsilon >= 0.0 && options.matching.epsilon <= 1e6)) {
    return absl::InvalidArgumentError("paper: epsilon of the matching is not within 0 to 1e6");
  }
  if (!(options.max_false_alarms > 0.0 && options.max_false_alarms < 1.0)) {
    return absl::InvalidArgumentError("paper: the number of false alarms is not between 0 and 1");
  }
  return Validate(options.ransac);
}

absl::StatusOr<PaperFeatures> ComputePaperFeatures(const Scan& scan, const PaperOptions& options, const Stop& stop) {
  if (absl::Status status = AskStop(stop); !status.ok()) return status;
  absl::StatusOr<RangeImage> image = ComputeRangeImage(scan.points, options.image);
  if (!image.ok()) return image.status();
  if (image->range.empty()) return PaperFeatures{};
  if (absl::Status status = AskStop(stop); !status.ok()) return status;
  absl::StatusOr<std::vector<Image<float>>> bands =
      ComputeScaleBands(Conditioned(*image, options.blur_sigma_px),
                        {.num_scales = options.num_scales, .windows = WindowShape::kCartesian});
  if (!bands.ok()) return bands.status();
  if (absl::Status status = AskStop(stop); !status.ok()) return status;
  for (Image<float>& band : *bands) band = WrappedAround(band);
  const std::vector<Keypoint> keypoints = DetectOnReturns(*bands, *image, options);
  PaperFeatures result;
  result.features = DescribeKeypoints(*bands, keypoints, options.descriptors);
  for (Keypoint& keypoint : result.features.keypoints) {
    const int32_t point = ReturnOf(keypoint, *image, options.min_range_m);
    result.points.push_back(scan.points[static_cast<size_t>(point)].cast<double>());
    keypoint.col -= static_cast<float>(kWrapPx);
  }
  return result;
}

absl::StatusOr<RegistrationResult> RegisterPaper(const Scan& source, const Scan& target, const PaperOptions& options,
                                                 const Stop& stop) {
  if (absl::Status status = Validate(options); !status.ok()) return status;
  StageTimer timer;
  RegistrationResult result;
  const absl::StatusOr<std::array<PaperFeatures, 2>> features = FeaturesOfBoth(source, target, options, stop);
  if (absl::IsDeadlineExceeded(features.status())) {
    Reject(Reason::kDeadline, result);
    return result;
  }
  if (!features.ok()) return features.status();
  timer.Lap("features");
  const auto& [source_features, target_features] = *features;
  const std::vector<Match> matches =
      MatchApproximateMutualNearest(source_features.features, target_features.features, options.matching);
  timer.Lap("matching");
  result.evidence.num_source_keypoints = static_cast<int>(source_features.features.size());
  result.evidence.num_target_keypoints = static_cast<int>(target_features.features.size());
  result.evidence.num_matches = static_cast<int>(matches.size());
  result.evidence.num_attempts = 1;
  const std::vector<PointPair> pairs = PairsOf(source_features, target_features, matches);
  if (absl::Status status = EstimatePose(pairs, options, stop, result); !status.ok()) return status;
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
