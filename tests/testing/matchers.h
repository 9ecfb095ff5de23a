// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Matchers that many tests share.
#ifndef CURVEREG_TESTS_TESTING_MATCHERS_H_
#define CURVEREG_TESTS_TESTING_MATCHERS_H_

#include <gmock/gmock.h>

#include <optional>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/rigid_transform.h"

namespace curvereg::testing {

inline const absl::Status& StatusOf(const absl::Status& status) { return status; }
template <typename T>
const absl::Status& StatusOf(const absl::StatusOr<T>& result) {
  return result.status();
}

// EXPECT_THAT(result, IsOk()): a Status or StatusOr that is OK.
MATCHER(IsOk, "is OK") {
  *result_listener << StatusOf(arg);
  return StatusOf(arg).ok();
}

// EXPECT_THAT(result, HasCode(absl::StatusCode::kInvalidArgument)).
MATCHER_P(HasCode, code, "has the code " + absl::StatusCodeToString(code)) {
  *result_listener << StatusOf(arg);
  return StatusOf(arg).code() == code;
}

// EXPECT_THAT(T, IsNear(T_true, 0.01, 0.001)): translations within tolerance_m, rotations within tolerance_rad. A
// transform that is not there is near none.
MATCHER_P3(IsNear, T_expected, tolerance_m, tolerance_rad, "is a transform near the one given") {
  const std::optional<RigidTransform> T(arg);
  const std::optional<RigidTransform> T_near(T_expected);
  if (!T.has_value() || !T_near.has_value()) return false;
  const TransformDifference difference = Difference(*T_near, *T);
  *result_listener << "off by " << difference.translation_m << " m, " << difference.rotation_rad << " rad";
  return difference.translation_m <= tolerance_m && difference.rotation_rad <= tolerance_rad;
}

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_TESTING_MATCHERS_H_
