// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What the tests of conversions share.
#ifndef CURVEREG_TESTS_WIRE_CONVERSION_SAMPLES_H_
#define CURVEREG_TESTS_WIRE_CONVERSION_SAMPLES_H_

#include <limits>
#include <string>

#include "core/base/rigid_transform.h"
#include "wire/error.h"

namespace curvereg::wire {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

// "field" of the only violation; empty when the status is not INVALID_FIELD.
inline std::string FieldOf(const absl::Status& status) {
  const auto bad_request = BadRequestOf(status);
  if (ReasonOf(status) != v1::ERROR_REASON_INVALID_FIELD || !bad_request.has_value()) return "";
  return bad_request->field_violations_size() == 1 ? bad_request->field_violations(0).field() : "";
}

inline RigidTransform SomePose() {
  RigidTransform T = RigidTransform::Identity();
  T.linear() = RotationFromVector({0.3, -0.7, 2.1});
  T.translation() << 12.5, -3.25, 0.125;
  return T;
}

// Symmetric, positive definite, every entry another number.
inline Matrix6d SomeCovariance() {
  Matrix6d A;
  for (int i = 0; i < 36; ++i) A.data()[i] = 0.01 * ((i * 7) % 11) - 0.03 + (i % 7 == 0 ? 0.2 : 0.0);
  const Matrix6d S = A * A.transpose();
  return 0.5 * (S + S.transpose()) + 1e-3 * Matrix6d::Identity();
}

}  // namespace curvereg::wire

#endif  // CURVEREG_TESTS_WIRE_CONVERSION_SAMPLES_H_
