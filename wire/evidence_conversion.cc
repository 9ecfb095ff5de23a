// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/evidence_conversion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "wire/error.h"

namespace curvereg::wire {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// One number under its name in the contract.
struct Count {
  const char* name;
  int Evidence::*member;
  uint32_t (v1::Evidence::*get)() const;
  void (v1::Evidence::*set)(uint32_t);
};
struct Measure {
  const char* name;
  std::optional<double> Evidence::*member;
  bool (v1::Evidence::*has)() const;
  double (v1::Evidence::*get)() const;
  void (v1::Evidence::*set)(double);
  double min;
  double max;
};

using Ours = Evidence;
using Wire = v1::Evidence;

constexpr std::array<Count, 6> kCounts = {
    {{"source_keypoint_count", &Ours::num_source_keypoints, &Wire::source_keypoint_count,
      &Wire::set_source_keypoint_count},
     {"target_keypoint_count", &Ours::num_target_keypoints, &Wire::target_keypoint_count,
      &Wire::set_target_keypoint_count},
     {"match_count", &Ours::num_matches, &Wire::match_count, &Wire::set_match_count},
     {"inlier_count", &Ours::num_inliers, &Wire::inlier_count, &Wire::set_inlier_count},
     {"hypothesis_count", &Ours::num_hypotheses, &Wire::hypothesis_count, &Wire::set_hypothesis_count},
     {"attempt_count", &Ours::num_attempts, &Wire::attempt_count, &Wire::set_attempt_count}}};

// Shares may be a rounding error beyond their range; the confidence of a pose may be 0, and then the ratio of
// the runner-up is infinite.
constexpr double kSlack = 1e-9;
constexpr std::array<Measure, 9> kMeasures = {
    {{"source_overlap", &Ours::overlap_source, &Wire::has_source_overlap, &Wire::source_overlap,
      &Wire::set_source_overlap, -kSlack, 1.0 + kSlack},
     {"target_overlap", &Ours::overlap_target, &Wire::has_target_overlap, &Wire::target_overlap,
      &Wire::set_target_overlap, -kSlack, 1.0 + kSlack},
     {"free_space_agreement", &Ours::free_space_agreement, &Wire::has_free_space_agreement, &Wire::free_space_agreement,
      &Wire::set_free_space_agreement, -kSlack, 1.0 + kSlack},
     {"image_correlation", &Ours::image_correlation, &Wire::has_image_correlation, &Wire::image_correlation,
      &Wire::set_image_correlation, -1.0 - kSlack, 1.0 + kSlack},
     {"inlier_fraction", &Ours::inlier_fraction, &Wire::has_inlier_fraction, &Wire::inlier_fraction,
      &Wire::set_inlier_fraction, -kSlack, 1.0 + kSlack},
     {"residual_rmse_m", &Ours::residual_rmse_m, &Wire::has_residual_rmse_m, &Wire::residual_rmse_m,
      &Wire::set_residual_rmse_m, 0.0, kInfinity},
     {"residual_median_m", &Ours::residual_median_m, &Wire::has_residual_median_m, &Wire::residual_median_m,
      &Wire::set_residual_median_m, 0.0, kInfinity},
     {"residual_p90_m", &Ours::residual_p90_m, &Wire::has_residual_p90_m, &Wire::residual_p90_m,
      &Wire::set_residual_p90_m, 0.0, kInfinity},
     {"runner_up_ratio", &Ours::runner_up_ratio, &Wire::has_runner_up_ratio, &Wire::runner_up_ratio,
      &Wire::set_runner_up_ratio, 0.0, kInfinity}}};

}  // namespace

v1::Evidence ToWire(const Evidence& evidence) {
  v1::Evidence message;
  message.set_source_point_count(static_cast<uint64_t>(std::max<int64_t>(evidence.num_source_points, 0)));
  message.set_target_point_count(static_cast<uint64_t>(std::max<int64_t>(evidence.num_target_points, 0)));
  for (const Count& count : kCounts) {
    (message.*count.set)(static_cast<uint32_t>(std::max(evidence.*count.member, 0)));
  }
  for (const Measure& measure : kMeasures) {
    const std::optional<double>& value = evidence.*measure.member;
    if (value.has_value() && !std::isnan(*value)) (message.*measure.set)(*value);
  }
  return message;
}

absl::StatusOr<Evidence> FromWire(const v1::Evidence& evidence) {
  constexpr auto kMaxInt = static_cast<uint32_t>(std::numeric_limits<int>::max());
  constexpr auto kMaxInt64 = static_cast<uint64_t>(std::numeric_limits<int64_t>::max());
  Evidence result;
  if (evidence.source_point_count() > kMaxInt64) return FieldError("source_point_count", "out of range");
  if (evidence.target_point_count() > kMaxInt64) return FieldError("target_point_count", "out of range");
  result.num_source_points = static_cast<int64_t>(evidence.source_point_count());
  result.num_target_points = static_cast<int64_t>(evidence.target_point_count());
  for (const Count& count : kCounts) {
    const uint32_t value = (evidence.*count.get)();
    if (value > kMaxInt) return FieldError(count.name, "out of range");
    result.*count.member = static_cast<int>(value);
  }
  for (const Measure& measure : kMeasures) {
    if (!(evidence.*measure.has)()) continue;
    const double value = (evidence.*measure.get)();
    if (!(value >= measure.min && value <= measure.max)) return FieldError(measure.name, "out of range");
    result.*measure.member = value;
  }
  return result;
}

}  // namespace curvereg::wire
