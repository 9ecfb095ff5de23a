// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/methods/verdict.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/small_matrices.h"

namespace curvereg {

PoseCheck CheckPose(const PreparedScan& source, const PreparedScan& target, const RigidTransform& T_target_source) {
  const FreeSpaceAgreement of_source = AskAll(target.free_space(), T_target_source, source.downsampled_points());
  const FreeSpaceAgreement of_target =
      AskAll(source.free_space(), T_target_source.inverse(), target.downsampled_points());
  PoseCheck check;
  check.free_space_agreement = std::min(of_source.Agreement(), of_target.Agreement());
  check.overlap_source = of_source.Overlap();
  check.overlap_target = of_target.Overlap();
  return check;
}

ViewCorrelation CorrelateViews(const ViewFeatures& source, const ViewFeatures& target,
                               const RigidTransform& T_target_source) {
  constexpr int kStride = 2;
  const Eigen::Matrix3d R = target.R_level_sensor * T_target_source.linear() * source.R_level_sensor.transpose();
  const Eigen::Vector3d t = target.R_level_sensor * T_target_source.translation();
  const Image<float>& a = source.band_pass;
  const Image<float>& b = target.band_pass;
  double n = 0.0, sum_a = 0.0, sum_b = 0.0, sum_aa = 0.0, sum_bb = 0.0, sum_ab = 0.0;
  for (int row = 0; row < a.rows; row += kStride) {
    for (int col = 0; col < a.cols; col += kStride) {
      if (source.valid(row, col) == 0) continue;
      const Eigen::Vector2d from = source.image.PositionOf(row, col);
      const Eigen::Vector2d to = R.topLeftCorner<2, 2>() * from + t.head<2>();
      const Eigen::Vector2d pixel = target.image.PixelOf(to);
      const int target_row = static_cast<int>(std::lround(pixel.x()));
      const int target_col = static_cast<int>(std::lround(pixel.y()));
      if (!b.Contains(target_row, target_col) || target.valid(target_row, target_col) == 0) continue;
      const double value_a = a(row, col);
      const double value_b = b(target_row, target_col);
      n += 1.0;
      sum_a += value_a;
      sum_b += value_b;
      sum_aa += value_a * value_a;
      sum_bb += value_b * value_b;
      sum_ab += value_a * value_b;
    }
  }
  ViewCorrelation correlation;
  correlation.num_pixels = static_cast<int>(n);
  if (n < 2.0) return correlation;
  const double variance_a = sum_aa - sum_a * sum_a / n;
  const double variance_b = sum_bb - sum_b * sum_b / n;
  if (variance_a > 0.0 && variance_b > 0.0) {
    correlation.ncc = (sum_ab - sum_a * sum_b / n) / std::sqrt(variance_a * variance_b);
  }
  return correlation;
}

namespace {

// The exponents were fitted by conditional logit to hypotheses of real and simulated pairs (docs/method.md). Violated
// free space and surfels that do not fit weigh most, the correlation of the views least.
double FreeSpaceFactor(const PoseEvidence& evidence) { return std::pow(evidence.check.free_space_agreement, 20); }
double SurfaceFactor(const PoseEvidence& evidence) { return std::pow(evidence.fit.inlier_fraction, 10); }

}  // namespace

double SurfaceConsistency(const PoseEvidence& evidence) { return FreeSpaceFactor(evidence) * SurfaceFactor(evidence); }

double PoseConfidence(const PoseEvidence& evidence) {
  const double overlap = std::min(evidence.check.overlap_source, evidence.check.overlap_target);
  return SurfaceConsistency(evidence) * overlap * std::pow(0.1 + std::max(0.0, evidence.image_correlation), 0.2);
}

double PoseScore(const PoseEvidence& evidence) {
  constexpr double kSmallResidual = 0.02;  // [m] keeps a perfect fit of few surfels from outweighing all else
  constexpr double kFreeInliers = 4.0;     // so that a pose that no match proposed (prior, identity) has a score
  return PoseConfidence(evidence) * std::sqrt(kFreeInliers + evidence.num_inliers) /
         (evidence.fit.residual_rms_m + kSmallResidual);
}

std::vector<DegenerateDirection> FindDegenerateDirections(const SurfaceFit& fit, double min_information_z) {
  // Rotations in units that move the surface as much as translations do: divide by its typical distance.
  const double rotation_trace = fit.information.topLeftCorner<3, 3>().trace();
  const double translation_trace = fit.information.bottomRightCorner<3, 3>().trace();
  if (!(rotation_trace > 0.0) || !(translation_trace > 0.0)) return {};
  Vector6d scale;
  scale.head<3>().setConstant(1.0 / std::sqrt(rotation_trace / translation_trace));
  scale.tail<3>().setOnes();
  const Matrix6d information = scale.asDiagonal() * fit.cross_information * scale.asDiagonal();
  const SymmetricEigen<6> eigen = EigenOf(information);
  std::vector<DegenerateDirection> directions;
  for (int i = 0; i < 6; ++i) {
    const Vector6d direction = eigen.vectors.col(i);
    const double noise = std::sqrt(std::max(0.0, fit.NoiseVarianceAlong(scale.asDiagonal() * direction)));
    const double value = eigen.values[i];
    if (value > min_information_z * noise) continue;
    DegenerateDirection degenerate;
    degenerate.direction = (scale.asDiagonal() * direction).normalized();
    const double information_along = degenerate.direction.dot(fit.cross_information * degenerate.direction);
    degenerate.sigma =
        information_along > 0.0 ? 1.0 / std::sqrt(information_along) : std::numeric_limits<double>::infinity();
    directions.push_back(degenerate);
  }
  return directions;
}

Verdict DecideVerdict(const PoseEvidence& evidence, const std::vector<DegenerateDirection>& degenerate,
                      const VerdictOptions& options) {
  Verdict verdict;
  verdict.reasons.clear();
  const auto reject_if = [&verdict](bool condition, Reason reason) {
    if (condition) verdict.reasons.push_back(reason);
  };
  // Written so that what is not a number rejects.
  const bool overlaps =
      evidence.check.overlap_source >= options.min_overlap && evidence.check.overlap_target >= options.min_overlap;
  reject_if(evidence.fit.num_pairs < kMinSurfelPairs && evidence.fit.num_surfels < 2 * kMinSurfelPairs,
            Reason::kTooFewPoints);
  // Consistency is a product; the reason named is the factor that falls short most.
  const bool consistent = SurfaceConsistency(evidence) >= options.min_consistency;
  const bool surfaces_are_worse = !(SurfaceFactor(evidence) >= FreeSpaceFactor(evidence));
  reject_if(!consistent && surfaces_are_worse, Reason::kResidualTooHigh);
  reject_if(!overlaps, Reason::kOverlapTooLow);
  reject_if(!consistent && !surfaces_are_worse, Reason::kFreeSpaceViolated);
  const double appearance = evidence.image_correlation + 0.05 * std::min(evidence.num_inliers, 10);
  const bool looks_alike =
      evidence.image_correlation >= options.min_image_correlation && appearance >= options.min_appearance;
  reject_if(!looks_alike, Reason::kNoConsensus);
  reject_if(!(evidence.runner_up_ratio <= options.max_runner_up_ratio), Reason::kAmbiguous);
  reject_if(!degenerate.empty(), Reason::kDegenerateDirection);
  verdict.accepted = verdict.reasons.empty();
  return verdict;
}

void FillResult(const RigidTransform& T_target_source, const PoseEvidence& evidence, RegistrationResult& result) {
  const VerdictOptions options;
  result.T_target_source = T_target_source;
  result.degenerate_directions = FindDegenerateDirections(evidence.fit, options.min_information_z);
  result.verdict = DecideVerdict(evidence, result.degenerate_directions, options);
  result.covariance.reset();
  if (evidence.fit.num_pairs >= kMinSurfelPairs) result.covariance = PoseCovariance(evidence.fit);
  Evidence& measures = result.evidence;
  measures.num_inliers = evidence.num_inliers;
  measures.num_matches = evidence.num_matches;
  measures.overlap_source = evidence.check.overlap_source;
  measures.overlap_target = evidence.check.overlap_target;
  measures.free_space_agreement = evidence.check.free_space_agreement;
  measures.image_correlation = evidence.image_correlation;
  measures.inlier_fraction = evidence.fit.inlier_fraction;
  measures.runner_up_ratio = evidence.runner_up_ratio;
  if (!result.covariance.has_value()) return;  // without common surface there is no residual
  measures.residual_rmse_m = evidence.fit.residual_rms_m;
  measures.residual_median_m = evidence.fit.residual_median_m;
  measures.residual_p90_m = evidence.fit.residual_p90_m;
}

}  // namespace curvereg
