// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#ifndef CURVEREG_TESTS_TESTING_RESULT_BYTES_H_
#define CURVEREG_TESTS_TESTING_RESULT_BYTES_H_

#include <optional>
#include <string>

#include "core/methods/registration_result.h"
#include "tests/testing/same_bytes.h"

namespace curvereg::testing {

// Every byte of a result but its times; the names of the stages count.
inline std::string BytesOf(const RegistrationResult& result) {
  ByteLog log;
  log.Add(result.T_target_source.value_or(RigidTransform::Identity()).data(), 16);
  log.Add(result.T_target_source.has_value());
  log.Add(result.covariance.value_or(Matrix6d::Zero()).data(), 36);
  log.Add(result.covariance.has_value());
  log.Add(result.verdict.accepted);
  for (const Reason reason : result.verdict.reasons) log.Add(static_cast<int>(reason));
  for (const DegenerateDirection& direction : result.degenerate_directions) {
    log.Add(direction.direction.data(), 6);
    log.Add(direction.sigma);
  }
  const Evidence& e = result.evidence;
  for (const int64_t count : {e.num_source_points, e.num_target_points}) log.Add(count);
  for (const int count : {e.num_source_keypoints, e.num_target_keypoints, e.num_matches, e.num_inliers,
                          e.num_hypotheses, e.num_attempts}) {
    log.Add(count);
  }
  for (const std::optional<double>& value :
       {e.overlap_source, e.overlap_target, e.free_space_agreement, e.image_correlation, e.inlier_fraction,
        e.residual_rmse_m, e.residual_median_m, e.residual_p90_m, e.runner_up_ratio}) {
    log.Add(value.value_or(-1.0));
  }
  log.Add(result.seed);
  std::string bytes = log.bytes();
  for (const std::string& text : {result.options_digest, result.source_digest, result.target_digest, result.build_id}) {
    bytes += text + ';';
  }
  for (const StageTime& time : result.stage_times) bytes += time.stage + ';';
  return bytes;
}

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_TESTING_RESULT_BYTES_H_
